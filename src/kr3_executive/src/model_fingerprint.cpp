#include "kr3_executive/model_fingerprint.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace kr3::executive
{

namespace
{

constexpr double kQuantum = 1e-9;
constexpr double kGreatestRounded = 1e9;

/// A bijection of 64 bits in which each bit of the input changes half of the output's.
/// Source: Stafford (2011), variant 13 of the finaliser of MurmurHash3.
std::uint64_t mixed(std::uint64_t number)
{
  number = (number ^ (number >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  number = (number ^ (number >> 27U)) * 0x94d049bb133111ebULL;
  return number ^ (number >> 31U);
}

std::uint64_t rotated(std::uint64_t number, unsigned bits)
{
  return (number << bits) | (number >> (64U - bits));
}

void addRow(Fingerprinter& fingerprinter, const pomdp::SparseRow& row)
{
  fingerprinter.add(static_cast<std::uint64_t>(row.size()));
  for (const pomdp::SparseEntry& entry : row)
  {
    fingerprinter.add(static_cast<std::uint64_t>(entry.index));
    fingerprinter.add(entry.probability);
  }
}

}  // namespace

std::string toString(const Fingerprint& fingerprint)
{
  char digits[33];
  std::snprintf(digits, sizeof(digits), "%016llx%016llx",
                static_cast<unsigned long long>(fingerprint.high),
                static_cast<unsigned long long>(fingerprint.low));
  return digits;
}

std::optional<Fingerprint> parseFingerprint(const std::string& text)
{
  Fingerprint fingerprint;
  if (text.size() != 32)
  {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const char c = text[i];
    const bool is_digit = c >= '0' && c <= '9';
    if (!is_digit && (c < 'a' || c > 'f'))
    {
      return std::nullopt;
    }
    std::uint64_t& half = i < 16 ? fingerprint.high : fingerprint.low;
    half = (half << 4U) | static_cast<std::uint64_t>(is_digit ? c - '0' : c - 'a' + 10);
  }
  return fingerprint;
}

void Fingerprinter::add(std::uint64_t number)
{
  // Two chains that share nothing but the input: each step is a bijection of its own state.
  ++count_;
  const std::uint64_t input = mixed(number + 0x632be59bd9b4e019ULL);
  high_ = mixed(high_ ^ input);
  low_ = rotated(low_ + input, 23U) * 0x9fb21c651e98df25ULL;
}

void Fingerprinter::add(double number)
{
  if (std::abs(number) < kGreatestRounded)
  {
    add(static_cast<std::uint64_t>(std::llround(number / kQuantum)));
    return;
  }
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof(bits));
  add(bits);
}

void Fingerprinter::addText(const std::string& text)
{
  add(static_cast<std::uint64_t>(text.size()));
  for (std::size_t i = 0; i < text.size(); i += sizeof(std::uint64_t))
  {
    std::uint64_t number = 0;
    for (std::size_t j = i; j < std::min(i + sizeof number, text.size()); ++j)
      number = number << 8U | static_cast<unsigned char>(text[j]);
    add(number);
  }
}

Fingerprint Fingerprinter::result() const
{
  return {mixed(high_ ^ count_), mixed(low_ + count_)};
}

Fingerprint fingerprintOf(const pomdp::Model& model)
{
  Fingerprinter fingerprinter;
  fingerprinter.add(static_cast<std::uint64_t>(model.numStates()));
  fingerprinter.add(static_cast<std::uint64_t>(model.numActions()));
  fingerprinter.add(static_cast<std::uint64_t>(model.numObservations()));
  fingerprinter.add(model.discount());
  for (std::size_t action = 0; action < model.numActions(); ++action)
  {
    for (std::size_t state = 0; state < model.numStates(); ++state)
    {
      addRow(fingerprinter, model.transitions(action, state));
      addRow(fingerprinter, model.observations(action, state));
      fingerprinter.add(model.reward(action, state));
    }
  }
  return fingerprinter.result();
}

Fingerprint startFingerprintOf(const pomdp::Model& model)
{
  Fingerprinter fingerprinter;
  for (const double probability : model.initialBelief().probabilities())
  {
    fingerprinter.add(probability);
  }
  fingerprinter.add(static_cast<std::uint64_t>(model.initialLabels().size()));
  for (const std::uint32_t label : model.initialLabels())
  {
    fingerprinter.add(static_cast<std::uint64_t>(label));
  }
  return fingerprinter.result();
}

}  // namespace kr3::executive
