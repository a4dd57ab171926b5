#include "kr3_pomdp/policy_bundle.hpp"

#include <array>
#include <cstdio>
#include <istream>
#include <iterator>
#include <memory>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr const char* kMagic = "kr3_policy_bundle 1";
constexpr const char* kLoaded = "loaded";

std::string exact(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

std::string bodyOf(const SolvedModel& solved)
{
  std::ostringstream body;
  const SolverLimits& limits = solved.limits;
  body << "limits " << exact(limits.precision) << ' ' << exact(limits.time_s) << ' '
       << limits.max_backups << ' ' << limits.max_memory_bytes << ' ' << limits.num_threads << '\n';
  body << "bounds " << exact(solved.lower) << ' ' << exact(solved.upper) << '\n';
  body << "work " << solved.backups << ' ' << exact(solved.cpu_s) << ' ' << exact(solved.elapsed_s)
       << ' ' << solved.search_memory_bytes << '\n';
  body << "reason " << solved.reasonText() << '\n';
  body << "format " << solved.source->text.format << '\n';
  body << "model " << solved.source->text.text.size() << '\n' << solved.source->text.text << '\n';
  std::ostringstream policy;
  if (solved.policy)
  {
    solved.policy->write(policy);
  }
  body << "policy " << policy.str().size() << '\n' << policy.str() << '\n';
  return body.str();
}

/// Reads the lines and texts of a bundle in their order.
class BundleReader
{
public:
  BundleReader(std::string text, std::string name) : text_(std::move(text)), name_(std::move(name))
  {
  }

  [[noreturn]] void fail(const std::string& what) const
  {
    throw InvalidArgument(name_ + ": " + what);
  }

  /// The next line.
  std::string line()
  {
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string::npos)
    {
      fail("the bundle of a policy ends too early");
    }
    std::string found = text_.substr(position_, end - position_);
    position_ = end + 1;
    return found;
  }

  /// What follows `key` in the next line.
  std::string value(const std::string& key)
  {
    const std::string found = line();
    if (found.compare(0, key.size() + 1, key + ' ') != 0)
    {
      fail("found '" + found.substr(0, 60) + "', expected '" + key + "'");
    }
    return found.substr(key.size() + 1);
  }

  /// The numbers that follow `key`.
  template <typename... Numbers>
  void numbers(const std::string& key, Numbers&... into)
  {
    std::istringstream in(value(key));
    (number(in, key, into), ...);
  }

  /// The text whose length follows `key`.
  std::string block(const std::string& key)
  {
    std::size_t size = 0;
    numbers(key, size);
    if (size >= text_.size() - position_ || text_[position_ + size] != '\n')
    {
      fail("the text of the " + key + " is cut short");
    }
    std::string found = text_.substr(position_, size);
    position_ += size + 1;
    return found;
  }

  [[nodiscard]] std::string rest() const { return text_.substr(position_); }

private:
  template <typename Number>
  void number(std::istringstream& in, const std::string& key, Number& into)
  {
    std::string word;
    in >> word;
    std::size_t used = 0;
    try
    {
      if constexpr (std::is_same_v<Number, double>)
      {
        into = std::stod(word, &used);
      }
      else
      {
        into = static_cast<Number>(std::stoull(word, &used));
      }
    }
    catch (const std::logic_error&)  // not a number, or out of range
    {
      used = std::string::npos;
    }
    if (used != word.size())
    {
      fail("found '" + word + "' in the line '" + key + "', expected a number");
    }
  }

  std::string text_;
  std::string name_;
  std::size_t position_ = 0;
};

std::optional<StopReason> reasonNamed(const std::string& text, const BundleReader& reader)
{
  if (text == kLoaded)
  {
    return std::nullopt;
  }
  for (const StopReason reason :
       {StopReason::kPrecision, StopReason::kTimeLimit, StopReason::kBackupLimit,
        StopReason::kCancelled, StopReason::kMemoryLimit})
  {
    if (text == toString(reason))
    {
      return reason;
    }
  }
  reader.fail("found the reason '" + text + "', expected one of the solver's");
}

}  // namespace

void writeBundle(std::ostream& out, const SolvedModel& solved)
{
  const std::string body = bodyOf(solved);
  out << kMagic << "\nhash " << contentHash(body) << '\n' << body;
}

SolvedModel readBundle(std::istream& in, const std::string& name, std::size_t max_bytes,
                       const ReadOptions& options)
{
  std::string text;
  std::array<char, 1U << 16U> buffer{};
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0)
  {
    text.append(buffer.data(), static_cast<std::size_t>(in.gcount()));
    if (max_bytes != 0 && text.size() > max_bytes)
    {
      throw ResourceExhausted(name + ": a bundle of more than " + std::to_string(max_bytes) +
                              " bytes");
    }
  }
  BundleReader reader(std::move(text), name);
  if (const std::string first = reader.line(); first != kMagic)
  {
    reader.fail("found '" + first.substr(0, 60) + "', expected '" + kMagic + "'");
  }
  const std::string hash = reader.value("hash");
  if (hash != contentHash(reader.rest()))
  {
    reader.fail("the bundle was cut short or changed since it was written");
  }
  SolvedModel solved{};
  SolverLimits& limits = solved.limits;
  reader.numbers("limits", limits.precision, limits.time_s, limits.max_backups,
                 limits.max_memory_bytes, limits.num_threads);
  reader.numbers("bounds", solved.lower, solved.upper);
  reader.numbers("work", solved.backups, solved.cpu_s, solved.elapsed_s,
                 solved.search_memory_bytes);
  solved.reason = reasonNamed(reader.value("reason"), reader);
  ModelText model_text{reader.value("format"), ""};
  if (model_text.format != "pomdp" && model_text.format != "pomdpx")
  {
    reader.fail("found the format '" + model_text.format + "', expected 'pomdp' or 'pomdpx'");
  }
  model_text.text = reader.block("model");
  const std::string policy_text = reader.block("policy");
  Model model = readModel(model_text, name + " (model)", options);
  solved.source =
      std::make_shared<const NamedModel>(NamedModel{std::move(model_text), std::move(model)});
  std::optional<Policy> policy;
  if (!policy_text.empty())
  {
    std::istringstream policy_in(policy_text);
    policy = Policy::read(policy_in, name + " (policy)");
  }
  try  // to see that they fit
  {
    solved.policy = std::move(unsolvedModel(solved.source, std::move(policy)).policy);
  }
  catch (const InvalidArgument& e)
  {
    reader.fail(e.what());
  }
  return solved;
}

}  // namespace kr3::pomdp
