#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <kr3_pomdp/model.hpp>

namespace kr3::executive
{

/// 128 bits that stand for a content. Not cryptographic: contents that nobody made on purpose meet
/// with a probability of about n^2 / 2^129 among n of them (less than 1e-26 for a million).
struct Fingerprint
{
  std::uint64_t high = 0;
  std::uint64_t low = 0;

  bool operator==(const Fingerprint& other) const { return high == other.high && low == other.low; }
  bool operator!=(const Fingerprint& other) const { return !(*this == other); }
};

/// 32 hexadecimal digits.
[[nodiscard]] std::string toString(const Fingerprint& fingerprint);

/// What toString() wrote; nothing for other texts.
[[nodiscard]] std::optional<Fingerprint> parseFingerprint(const std::string& text);

/// Takes in numbers one after the other; their order counts. The result is the same on every
/// machine.
class Fingerprinter
{
public:
  void add(std::uint64_t number);
  /// Rounded to 1e-9, so that sums in another order are the same number; beyond 1e9 as it is.
  void add(double number);
  /// With its length, so that texts do not run together.
  void addText(const std::string& text);
  [[nodiscard]] Fingerprint result() const;

private:
  std::uint64_t high_ = 0x9e3779b97f4a7c15ULL;
  std::uint64_t low_ = 0xc2b2ae3d27d4eb4fULL;
  std::uint64_t count_ = 0;
};

/// What a policy's validity depends on: numbers of states, actions and observations, T, O, R and
/// the discount, by index. Names do not count, nor where the robot starts: an alpha vector bounds
/// its plan's value at every belief. Numbers that differ by less than 1e-9 may count as equal; the
/// values of a policy then differ by less than 1e-9 r / (1 - discount)^2, r the greatest reward.
[[nodiscard]] Fingerprint fingerprintOf(const pomdp::Model& model);

/// Where the robot starts, and what it sees there.
[[nodiscard]] Fingerprint startFingerprintOf(const pomdp::Model& model);

}  // namespace kr3::executive

template <>
struct std::hash<kr3::executive::Fingerprint>
{
  std::size_t operator()(const kr3::executive::Fingerprint& fingerprint) const noexcept
  {
    return static_cast<std::size_t>(fingerprint.high ^ fingerprint.low);
  }
};
