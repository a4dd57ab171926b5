#include "kr3_pomdp/model_text.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "file_text.hpp"
#include "file_tolerance.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMost = std::size_t{1} << 40U;  // what a product of counts is cut at

/// The number of combinations of the variables' values, at most kMost.
template <typename Variables>
std::size_t combinations(const Variables& variables)
{
  std::size_t product = 1;
  for (const Variable& variable : variables)
  {
    product = std::min(kMost, product * std::max<std::size_t>(1, variable.values.size()));
  }
  return product;
}

void checkCount(std::size_t count, std::size_t limit, const std::string& what)
{
  if (limit != 0 && count > limit)
  {
    throw ResourceExhausted("a model of " + std::to_string(count) + " " + what +
                            ", expected at most " + std::to_string(limit));
  }
}

/// What flattening would make, before it does.
void checkSize(const FactoredModel& model, const ReadOptions& options)
{
  const std::size_t num_states = combinations(model.state);
  const std::size_t num_actions = combinations(model.actions);
  std::size_t num_observations = combinations(model.observations);
  for (const StateVariable& variable : model.state)
  {
    if (variable.observed)
    {
      num_observations = std::min(kMost, num_observations * variable.values.size());
    }
  }
  checkCount(num_states, options.max_names, "states");
  checkCount(num_actions, options.max_names, "actions");
  checkCount(num_observations, options.max_names, "observations");
  checkCount(std::min(kMost, num_states) * std::min(std::size_t{1} << 20U, num_actions),
             options.max_rows, "rows (actions times states)");
}

Model readFactored(std::istringstream& in, const std::string& name, const ReadOptions& options)
{
  const FactoredModel factored = readPomdpx(in, name, options);
  checkSize(factored, options);
  if (options.keep_going && !options.keep_going())
  {
    throw Cancelled("reading the model was cancelled");
  }
  try
  {
    return factored.flattened(kFileSumTolerance);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(name + ": " + e.what());
  }
}

}  // namespace

const char* detectedFormat(const std::string& text)
{
  return looksLikeXml(text) ? "pomdpx" : "pomdp";
}

ModelText checkedModelText(const std::string& format, std::string text, std::size_t max_bytes)
{
  if (max_bytes != 0 && text.size() > max_bytes)
  {
    throw ResourceExhausted("a model of " + std::to_string(text.size()) +
                            " bytes, expected at most " + std::to_string(max_bytes));
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
  {
    throw InvalidArgument("the model's text is empty");
  }
  if (!format.empty() && format != "pomdp" && format != "pomdpx")
  {
    throw InvalidArgument("format '" + format + "', expected 'pomdp', 'pomdpx' or none");
  }
  ModelText result{format.empty() ? detectedFormat(text) : format, std::move(text)};
  return result;
}

Model readModel(const ModelText& text, const std::string& name, const ReadOptions& options)
{
  std::istringstream in(text.text);
  if (text.format == "pomdp")
  {
    return readPomdp(in, name, options);
  }
  if (text.format == "pomdpx")
  {
    return readFactored(in, name, options);
  }
  throw InvalidArgument("format '" + text.format + "', expected 'pomdp' or 'pomdpx'");
}

}  // namespace kr3::pomdp
