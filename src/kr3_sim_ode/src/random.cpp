#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

std::mt19937_64 makeGenerator(std::uint64_t seed, Stream stream)
{
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(stream)};
  return std::mt19937_64(sequence);
}

double uniform(std::mt19937_64& generator, double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(generator);
}

std::size_t uniformIndex(std::mt19937_64& generator, std::size_t count)
{
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(generator);
}

}  // namespace kr3::sim
