#include "pomdpx_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <istream>
#include <iterator>
#include <utility>

#include <kr3_common/error.hpp>

#include "file_tolerance.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "pomdpx_parameter.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxValues = 1000000;

bool isBlank(char c)
{
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string quoted(const std::string& text)
{
  return "'" + text + "'";
}

std::string readAll(std::istream& in)
{
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string readFile(const std::string& path)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  return readAll(in);
}

}  // namespace

PomdpxText::PomdpxText(std::string text, std::string name)
  : text_(std::move(text)), name_(std::move(name))
{
  const pugi::xml_parse_result result =
      document_.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
  {
    fail(result.offset, result.description(), "well-formed XML");
  }
}

void PomdpxText::fail(std::ptrdiff_t offset, const std::string& found,
                      const std::string& expected) const
{
  const std::size_t end =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), text_.size());
  const std::size_t line =
      1 + static_cast<std::size_t>(
              std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
  const std::size_t line_start = end == 0 ? std::string::npos : text_.rfind('\n', end - 1);
  const std::size_t column = line_start == std::string::npos ? end + 1 : end - line_start;
  throw InvalidArgument(name_ + ":" + std::to_string(line) + ":" + std::to_string(column) +
                        ": found " + found + ", expected " + expected);
}

void PomdpxText::fail(const pugi::xml_node& at, const std::string& found,
                      const std::string& expected) const
{
  fail(at.offset_debug() - 1, found, expected);  // from the name to its bracket
}

void PomdpxText::fail(const PomdpxWord& at, const std::string& expected) const
{
  fail(at.offset, quoted(at.text), expected);
}

std::vector<PomdpxWord> PomdpxText::words(const pugi::xml_node& element)
{
  std::vector<PomdpxWord> words;
  for (const pugi::xml_node& child : element.children())
  {
    if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata)
    {
      continue;
    }
    const char* const begin = child.value();
    const char* at = begin;
    while (true)
    {
      while (isBlank(*at))
      {
        ++at;
      }
      const char* const first = at;
      while (*at != '\0' && !isBlank(*at))
      {
        ++at;
      }
      if (first == at)
      {
        break;
      }
      words.push_back({{first, at}, child.offset_debug() + (first - begin)});
    }
  }
  return words;
}

pugi::xml_node PomdpxText::child(const pugi::xml_node& parent, const char* name) const
{
  const pugi::xml_node found = parent.child(name);
  if (!found)
  {
    fail(parent, std::string("<") + parent.name() + "> without it",
         std::string("a <") + name + "> inside");
  }
  return found;
}

std::string PomdpxText::attribute(const pugi::xml_node& element, const char* name) const
{
  const std::string value = element.attribute(name).value();
  if (value.empty())
  {
    fail(element, std::string("<") + element.name() + "> without it",
         std::string("an attribute '") + name + "'");
  }
  return value;
}

double PomdpxText::number(const PomdpxWord& word) const
{
  char* end = nullptr;
  const double value = std::strtod(word.text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value))
  {
    fail(word, "a number");
  }
  return value;
}

FactoredModel PomdpxReader::read()
{
  const pugi::xml_node root = text_.root();
  if (std::strcmp(root.name(), "pomdpx") != 0)
  {
    text_.fail(root, std::string("<") + root.name() + ">", "<pomdpx>");
  }
  const pugi::xml_node discount = text_.child(root, "Discount");
  const std::vector<PomdpxWord> words = PomdpxText::words(discount);
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
    const std::vector<PomdpxWord> words = PomdpxText::words(count);
    const double number = words.size() == 1 ? text_.number(words.front()) : 0.0;
    if (!(number >= 1.0 && number <= kMaxValues) || number != std::floor(number))
    {
      text_.fail(count, words.size() == 1 ? quoted(words.front().text) : "no single word",
                 "a number of values from 1 to " + std::to_string(kMaxValues));
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(number); ++i)
    {
      result.values.push_back(prefix + std::to_string(i));
    }
    return result;
  }
  for (const PomdpxWord& word : PomdpxText::words(text_.child(element, "ValueEnum")))
  {
    if (std::find(result.values.begin(), result.values.end(), word.text) != result.values.end())
    {
      text_.fail(word, "a value that " + quoted(result.name) + " does not have yet");
    }
    result.values.push_back(word.text);
  }
  if (result.values.empty())
  {
    text_.fail(element, "no values", "the values of " + quoted(result.name));
  }
  return result;
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
  for (const PomdpxWord& word : PomdpxText::words(element))
  {
    const auto found = names_.find(word.text);
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
    if (std::strcmp(child.name(), kind) != 0)
    {
      text_.fail(child, std::string("<") + child.name() + ">", std::string("<") + kind + ">");
    }
    Factor factor;
    const pugi::xml_node var = text_.child(child, "Var");
    if (rewards)
    {
      for (const PomdpxWord& word : PomdpxText::words(var))
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
    factor.values.assign(model_.sizeOf(factor), 0.0);
    PomdpxParameter(text_, model_, names_, factor).fill(text_.child(child, "Parameter"));
    factors.push_back(std::move(factor));
  }
  return factors;
}

FactoredModel readPomdpx(std::istream& in, const std::string& name)
{
  return PomdpxReader(readAll(in), name).read();
}

FactoredModel loadPomdpx(const std::string& path)
{
  return PomdpxReader(readFile(path), path).read();
}

Model loadModel(const std::string& path)
{
  std::string text = readFile(path);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string::npos || text[first] != '<')
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
