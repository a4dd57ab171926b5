// Our own text format of policies, see docs/pomdp_formats.md.

#include <algorithm>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "file_text.hpp"
#include "kr3_pomdp/policy.hpp"
#include "number_text.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::string_view kMagic = "kr3_policy";
constexpr std::size_t kVersion = 1;

/// Words of one line at a time.
class LineReader
{
public:
  LineReader(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name)) {}

  /// The next word of the line; empty at its end.
  std::string_view word()
  {
    const std::string_view blanks = " \t\r";
    while (position_ < text_.size() && blanks.find(text_[position_]) != std::string_view::npos)
    {
      ++position_;
    }
    word_start_ = position_;
    while (position_ < text_.size() && text_[position_] != '\n' &&
           blanks.find(text_[position_]) == std::string_view::npos)
    {
      ++position_;
    }
    return std::string_view(text_).substr(word_start_, position_ - word_start_);
  }

  /// @throws InvalidArgument  always, at the word taken last
  [[noreturn]] void fail(const std::string& expected) const
  {
    std::string found = "'" + text_.substr(word_start_, position_ - word_start_) + "'";
    if (word_start_ == position_)
    {
      found = position_ == text_.size() ? "the end of the text" : "the end of the line";
    }
    throw InvalidArgument(placeIn(text_, word_start_, name_) + "found " + found + ", expected " +
                          expected);
  }

  void expect(std::string_view expected)
  {
    if (word() != expected)
    {
      fail("'" + std::string(expected) + "'");
    }
  }

  std::size_t index(std::size_t limit, const std::string& expected)
  {
    const auto value = indexNumber(word());
    if (!value || *value >= limit)
    {
      fail(expected);
    }
    return *value;
  }

  double number(const std::string& expected)
  {
    const auto value = finiteNumber(word());
    if (!value)
    {
      fail(expected);
    }
    return *value;
  }

  void endOfLine()
  {
    if (!word().empty())
    {
      fail("the end of the line");
    }
    position_ += position_ < text_.size() ? 1 : 0;
  }

  /// Only blanks may follow.
  void endOfText()
  {
    while (word().empty() && position_ < text_.size())
    {
      ++position_;
    }
    if (word_start_ != position_)
    {
      fail("the end of the text");
    }
  }

private:
  std::string text_;
  std::string name_;
  std::size_t position_ = 0;
  std::size_t word_start_ = 0;
};

std::size_t header(LineReader& reader, std::string_view key)
{
  constexpr std::size_t kLimit = std::numeric_limits<std::uint32_t>::max();
  reader.expect(key);
  const std::size_t value = reader.index(kLimit, "a number below " + std::to_string(kLimit));
  reader.endOfLine();
  return value;
}

AlphaVector readVector(LineReader& reader, std::size_t num_states)
{
  AlphaVector vector;
  vector.action = reader.index(std::numeric_limits<std::uint32_t>::max(), "an action's index");
  const std::size_t count = reader.index(
      num_states + 1, "a number of states up to " + std::to_string(num_states) + ", 0 for all");
  // Nothing is reserved: the number may be wrong, but what was read is there.
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t state =
        reader.index(num_states, "a state's index below " + std::to_string(num_states));
    if (i > 0 && state <= vector.states.back())
    {
      reader.fail("states in ascending order");
    }
    vector.states.push_back(static_cast<std::uint32_t>(state));
  }
  const std::size_t num_values = count == 0 ? num_states : count;
  for (std::size_t i = 0; i < num_values; ++i)
  {
    vector.values.push_back(reader.number("a value, " + std::to_string(num_values) + " in all"));
  }
  reader.endOfLine();
  return vector;
}

}  // namespace

void Policy::write(std::ostream& out) const
{
  out << kMagic << ' ' << kVersion << "\nstates " << num_states_ << "\nvectors "
      << num_alpha_vectors_ << '\n';
  for (const AlphaVector& vector : alphaVectors())
  {
    out << vector.action << ' ' << vector.states.size();
    for (const std::uint32_t state : vector.states)
    {
      out << ' ' << state;
    }
    for (const double value : vector.values)
    {
      out << ' ' << exactText(value);
    }
    out << '\n';
  }
}

Policy Policy::read(std::istream& in, const std::string& name)
{
  LineReader reader(readAll(in, name), name);
  reader.expect(kMagic);
  if (reader.index(std::numeric_limits<std::size_t>::max(), "the version") != kVersion)
  {
    reader.fail("version " + std::to_string(kVersion));
  }
  reader.endOfLine();
  const std::size_t num_states = header(reader, "states");
  const std::size_t num_vectors = header(reader, "vectors");
  std::vector<AlphaVector> vectors;
  for (std::size_t i = 0; i < num_vectors; ++i)
  {
    vectors.push_back(readVector(reader, num_states));
  }
  reader.endOfText();
  const auto whole = [](const AlphaVector& vector) { return vector.states.empty(); };
  if (std::none_of(vectors.begin(), vectors.end(), whole))
  {
    throw InvalidArgument(name + ": found no vector over all states, expected one at least");
  }
  return Policy(num_states, vectors);
}

}  // namespace kr3::pomdp
