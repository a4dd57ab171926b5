#include "pomdpx_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <kr3_common/error.hpp>

#include "factor_product.hpp"
#include "file_text.hpp"
#include "file_tolerance.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "pomdpx_parameter.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxValues = 1000000;
constexpr std::size_t kMaxEntries = std::size_t{1} << 27;  // of all tables

std::string quoted(std::string_view text)
{
  return "'" + std::string(text) + "'";
}

}  // namespace

FactoredModel PomdpxReader::read()
{
  const pugi::xml_node root = text_.root();
  if (std::strcmp(root.name(), "pomdpx") != 0)
  {
    text_.fail(root, std::string("<") + root.name() + ">", "<pomdpx>");
  }
  const pugi::xml_node discount = text_.child(root, "Discount");
  const std::vector<XmlWord> words = XmlText::words(discount);
  if (words.size() != 1)
  {
    text_.fail(discount, std::to_string(words.size()) + " words", "one number");
  }
  model_.discount = text_.number(words.front());
  if (!(model_.discount > 0.0 && model_.discount <= 1.0))
  {
    text_.fail(words.front(), "a discount in (0, 1]");
  }
  variables(text_.child(root, "Variable"));
  model_.transitions = factors(text_.child(root, "StateTransitionFunction"), false);
  if (!model_.observations.empty())
  {
    model_.observing = factors(text_.child(root, "ObsFunction"), false);
  }
  model_.rewards = factors(text_.child(root, "RewardFunction"), true);
  const bool all_seen = std::all_of(model_.state.begin(), model_.state.end(),
                                    [](const StateVariable& v) { return v.observed; });
  if (all_seen && !root.child("InitialStateBelief"))
  {
    uniformStart();
  }
  else
  {
    model_.initial = factors(text_.child(root, "InitialStateBelief"), false);
  }
  return std::move(model_);
}

void PomdpxReader::uniformStart()
{
  for (std::size_t v = 0; v < model_.state.size(); ++v)
  {
    const std::size_t size = model_.state[v].values.size();
    model_.initial.push_back({{},
                              {{VariableRole::kPrevious, v}},
                              std::vector<double>(size, 1.0 / static_cast<double>(size))});
  }
}

void PomdpxReader::declare(const pugi::xml_node& element, const std::string& name, VariableRef ref)
{
  if (!names_.emplace(name, ref).second)
  {
    text_.fail(element, "a second variable " + quoted(name), "a new name");
  }
}

Variable PomdpxReader::variable(const pugi::xml_node& element, const char* name_attribute,
                                const char* prefix) const
{
  Variable result;
  result.name = text_.attribute(element, name_attribute);
  if (const pugi::xml_node count = element.child("NumValues"))
  {
    const std::vector<XmlWord> words = XmlText::words(count);
    const double number = words.size() == 1 ? text_.number(words.front()) : 0.0;
    if (!(number >= 1.0 && number <= kMaxValues) || number != std::floor(number))
    {
      text_.fail(count, words.size() == 1 ? quoted(words.front().text) : "no single word",
                 "a number of values from 1 to " + std::to_string(kMaxValues));
    }
    checkCount(count, static_cast<std::size_t>(number));
    for (std::size_t i = 0; i < static_cast<std::size_t>(number); ++i)
    {
      result.values.push_back(prefix + std::to_string(i));
    }
    return result;
  }
  std::unordered_set<std::string_view> seen;
  for (const XmlWord& word : XmlText::words(text_.child(element, "ValueEnum")))
  {
    if (!seen.insert(word.text).second)
    {
      text_.fail(word, "a value that " + quoted(result.name) + " does not have yet");
    }
    result.values.emplace_back(word.text);
  }
  checkCount(element, result.values.size());
  if (result.values.empty())
  {
    text_.fail(element, "no values", "the values of " + quoted(result.name));
  }
  return result;
}

void PomdpxReader::checkCount(const pugi::xml_node& element, std::size_t num_values) const
{
  if (options_.max_names != 0 && num_values > options_.max_names)
  {
    text_.failTooLarge(element, "found a variable of " + std::to_string(num_values) +
                                    " values, expected at most " +
                                    std::to_string(options_.max_names));
  }
}

void PomdpxReader::variables(const pugi::xml_node& element)
{
  for (const pugi::xml_node& child : element.children())
  {
    const std::string kind = child.name();
    if (kind == "StateVar")
    {
      const std::size_t index = model_.state.size();
      StateVariable state{variable(child, "vnamePrev", "s"), false};
      const std::string seen = child.attribute("fullyObs").as_string("false");
      if (seen != "true" && seen != "false")
      {
        text_.fail(child, "fullyObs = " + quoted(seen), "'true' or 'false'");
      }
      state.observed = seen == "true";
      declare(child, state.name, {VariableRole::kPrevious, index});
      declare(child, text_.attribute(child, "vnameCurr"), {VariableRole::kCurrent, index});
      model_.state.push_back(std::move(state));
    }
    else if (kind == "ActionVar")
    {
      model_.actions.push_back(variable(child, "vname", "a"));
      declare(child, model_.actions.back().name,
              {VariableRole::kAction, model_.actions.size() - 1});
    }
    else if (kind == "ObsVar")
    {
      model_.observations.push_back(variable(child, "vname", "o"));
      declare(child, model_.observations.back().name,
              {VariableRole::kObservation, model_.observations.size() - 1});
    }
    else if (kind == "RewardVar")
    {
      reward_names_.push_back(text_.attribute(child, "vname"));
    }
    else if (child.type() == pugi::node_element)
    {
      text_.fail(child, "<" + kind + ">", "<StateVar>, <ActionVar>, <ObsVar> or <RewardVar>");
    }
  }
  if (model_.state.empty() || model_.actions.empty())
  {
    text_.fail(element, model_.state.empty() ? "no state variable" : "no action variable",
               "at least one of each");
  }
}

std::vector<VariableRef> PomdpxReader::references(const pugi::xml_node& element) const
{
  std::vector<VariableRef> refs;
  for (const XmlWord& word : XmlText::words(element))
  {
    const auto found = names_.find(std::string(word.text));
    if (found != names_.end())
    {
      refs.push_back(found->second);
    }
    else if (word.text != "null")
    {
      text_.fail(word, "a declared variable");
    }
  }
  return refs;
}

std::vector<Factor> PomdpxReader::factors(const pugi::xml_node& section, bool rewards)
{
  std::vector<Factor> factors;
  const char* const kind = rewards ? "Func" : "CondProb";
  for (const pugi::xml_node& child : section.children())
  {
    if (child.type() != pugi::node_element)
    {
      continue;
    }
    if (options_.keep_going && !options_.keep_going())
    {
      throw Cancelled("reading the model was cancelled");
    }
    if (std::strcmp(child.name(), kind) != 0)
    {
      text_.fail(child, std::string("<") + child.name() + ">", std::string("<") + kind + ">");
    }
    Factor factor;
    const pugi::xml_node var = text_.child(child, "Var");
    if (rewards)
    {
      for (const XmlWord& word : XmlText::words(var))
      {
        if (std::find(reward_names_.begin(), reward_names_.end(), word.text) == reward_names_.end())
        {
          text_.fail(word, "a declared reward variable");
        }
      }
    }
    else
    {
      factor.of = references(var);
      if (factor.of.empty())
      {
        text_.fail(var, "no variable", "what the probabilities are of");
      }
    }
    factor.parents = references(text_.child(child, "Parent"));
    allocate(factor, child);
    PomdpxParameter(text_, model_, names_, factor, num_written_)
        .fill(text_.child(child, "Parameter"));
    if (!rewards)
    {
      checkSums(factor, child);
    }
    factors.push_back(std::move(factor));
  }
  return factors;
}

void PomdpxReader::allocate(Factor& factor, const pugi::xml_node& element)
{
  const std::size_t most =
      options_.max_entries == 0 ? kMaxEntries : std::min(options_.max_entries, kMaxEntries);
  std::size_t size = 1;
  for (const std::vector<VariableRef>* refs : {&factor.parents, &factor.of})
  {
    for (const VariableRef& ref : *refs)
    {
      size *= model_.variable(ref).values.size();
      if (size > most - num_entries_)
      {
        text_.failTooLarge(element, "found tables of more than " + std::to_string(most) +
                                        " entries, expected a model in smaller factors");
      }
    }
  }
  num_entries_ += size;
  factor.values.assign(size, 0.0);
}

void PomdpxReader::checkSums(const Factor& factor, const pugi::xml_node& element) const
{
  try
  {
    (void)FactorTable(model_, factor, kFileSumTolerance);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(text_.place(element) + e.what());
  }
}

FactoredModel readPomdpx(std::istream& in, const std::string& name, const ReadOptions& options)
{
  return PomdpxReader(readAll(in, name), name, options).read();
}

FactoredModel loadPomdpx(const std::string& path)
{
  return PomdpxReader(readFile(path), path).read();
}

Model loadModel(const std::string& path)
{
  std::string text = readFile(path);
  if (!looksLikeXml(text))
  {
    return loadPomdp(path);
  }
  const FactoredModel factored = PomdpxReader(std::move(text), path).read();
  try
  {
    return factored.flattened(kFileSumTolerance);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
}

}  // namespace kr3::pomdp
