#pragma once

#include <cstdint>
#include <random>

namespace kr3::sim
{

/// The independent sources of chance of one simulation. Each has its own generator, so that (say)
/// listening to the camera does not change what the laser measures.
enum class Stream : std::uint32_t
{
  kPlacement = 1,
  kLaser = 2,
  kOdometry = 3,
  kGripper = 4,
  kLight = 5,
  kCamera = 6,
  kDataset = 7,
  kDrop = 8,
};

/// The generator of one stream of the simulation with this seed.
[[nodiscard]] std::mt19937_64 makeGenerator(std::uint64_t seed, Stream stream);

/// Uniform in [low, high).
[[nodiscard]] double uniform(std::mt19937_64& generator, double low, double high);

/// Uniform in {0, ..., count - 1}; count >= 1.
[[nodiscard]] std::size_t uniformIndex(std::mt19937_64& generator, std::size_t count);

}  // namespace kr3::sim
