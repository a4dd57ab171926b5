#include "pomdpx_parameter.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "file_tolerance.hpp"
#include "number_text.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr int kMaxDepth = 200;
// A short text with wildcards can ask for any amount of time.
constexpr std::size_t kMaxWritten = std::size_t{1} << 32;

std::string named(const pugi::xml_node& element)
{
  return std::string("<") + element.name() + ">";
}

}  // namespace

PomdpxParameter::PomdpxParameter(const XmlText& text, const FactoredModel& model,
                                 const std::map<std::string, VariableRef>& names, Factor& factor,
                                 std::size_t& num_written)
  : text_(text)
  , model_(model)
  , names_(names)
  , factor_(factor)
  , num_written_(num_written)
  , scope_(factor.parents)
{
  scope_.insert(scope_.end(), factor.of.begin(), factor.of.end());
  for (const VariableRef& ref : factor.of)
  {
    num_outcomes_ *= model.variable(ref).values.size();
  }
  for (std::size_t i = 0; i < scope_.size(); ++i)
  {
    sizes_.push_back(variable(i).values.size());
  }
  strides_.assign(sizes_.size(), 1);
  for (std::size_t i = sizes_.size(); i-- > 1;)
  {
    strides_[i - 1] = strides_[i] * sizes_[i];
  }
}

void PomdpxParameter::fill(const pugi::xml_node& parameter)
{
  const std::string type = parameter.attribute("type").as_string("TBL");
  if (type == "TBL")
  {
    table(parameter);
  }
  else if (type == "DD")
  {
    diagram(parameter);
  }
  else
  {
    text_.fail(parameter, "type '" + type + "'", "'TBL' or 'DD'");
  }
}

template <typename Value>
void PomdpxParameter::set(const pugi::xml_node& at_element, const Box& box, const Value& value)
{
  std::size_t count = 1;
  for (std::size_t i = 0; i < box.size(); ++i)
  {
    count *= box[i] ? 1 : sizes_[i];
  }
  num_written_ += count;
  if (num_written_ > kMaxWritten)
  {
    text_.failTooLarge(at_element, "found entries written " + std::to_string(num_written_) +
                                       " times, expected at most " + std::to_string(kMaxWritten));
  }
  std::vector<std::size_t> at(box.size());
  std::vector<std::size_t> free;
  std::size_t index = 0;
  for (std::size_t i = 0; i < box.size(); ++i)
  {
    at[i] = box[i].value_or(0);
    index += at[i] * strides_[i];
    if (!box[i])
    {
      free.push_back(i);
    }
  }
  while (true)
  {
    factor_.values[index] = value(at);
    std::size_t i = free.size();
    while (i > 0 && at[free[i - 1]] + 1 == sizes_[free[i - 1]])
    {
      --i;
      index -= at[free[i]] * strides_[free[i]];
      at[free[i]] = 0;
    }
    if (i == 0)
    {
      return;
    }
    ++at[free[i - 1]];
    index += strides_[free[i - 1]];
  }
}

std::size_t PomdpxParameter::valueOf(const XmlWord& word, std::size_t place) const
{
  const std::vector<std::string>& values = variable(place).values;
  value_indices_.resize(scope_.size());
  std::unordered_map<std::string_view, std::size_t>& indices = value_indices_[place];
  if (indices.empty())
  {
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      indices.emplace(values[i], i);
    }
  }
  if (const auto found = indices.find(word.text); found != indices.end())
  {
    return found->second;
  }
  const std::size_t index = indexNumber(word.text).value_or(values.size());
  if (index >= values.size())
  {
    text_.fail(word, "a value of '" + variable(place).name + "', '*' or '-'");
  }
  return index;
}

void PomdpxParameter::table(const pugi::xml_node& parameter)
{
  for (const pugi::xml_node& child : parameter.children())
  {
    if (std::string_view(child.name()) == "Entry")
    {
      entry(child);
    }
    else if (child.type() == pugi::node_element)
    {
      text_.fail(child, named(child), "<Entry>");
    }
  }
}

void PomdpxParameter::entry(const pugi::xml_node& element)
{
  const pugi::xml_node instance = text_.child(element, "Instance");
  const std::vector<XmlWord> words = XmlText::words(instance);
  if (words.size() != scope_.size())
  {
    text_.fail(instance, std::to_string(words.size()) + " values",
               std::to_string(scope_.size()) + ": one for each parent, then for the variable");
  }
  Box box(scope_.size());
  std::vector<std::size_t> dashes;
  std::size_t expected = 1;
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    if (words[i].text == "-")
    {
      dashes.push_back(i);
      expected *= sizes_[i];
    }
    else if (words[i].text != "*")
    {
      box[i] = valueOf(words[i], i);
    }
  }
  const bool rewards = factor_.of.empty();
  // The format's documentation has rewards in either element.
  pugi::xml_node numbers = element.child(rewards ? "ValueTable" : "ProbTable");
  numbers = numbers ? numbers : text_.child(element, "ProbTable");
  const std::vector<XmlWord> given = XmlText::words(numbers);
  if (!rewards && given.size() == 1 && given.front().text == "uniform")
  {
    set(element, box, [this](const std::vector<std::size_t>&) {
      return 1.0 / static_cast<double>(num_outcomes_);
    });
    return;
  }
  if (!rewards && given.size() == 1 && given.front().text == "identity")
  {
    if (dashes.size() != 2 ||
        variable(dashes[0]).values.size() != variable(dashes[1]).values.size())
    {
      text_.fail(given.front(), "it with two '-' for variables of as many values");
    }
    set(element, box, [&](const std::vector<std::size_t>& at) {
      return at[dashes[0]] == at[dashes[1]] ? 1.0 : 0.0;
    });
    return;
  }
  if (given.size() != expected)
  {
    text_.fail(numbers, std::to_string(given.size()) + " numbers",
               std::to_string(expected) + ", one for each combination of '-'");
  }
  std::vector<double> values;
  for (const XmlWord& word : given)
  {
    values.push_back(text_.number(word));
    if (!rewards && !(values.back() >= 0.0 && values.back() <= 1.0 + kFileSumTolerance))
    {
      text_.fail(word, "a probability in [0, 1]");
    }
  }
  set(element, box, [&](const std::vector<std::size_t>& at) {
    std::size_t index = 0;
    for (const std::size_t place : dashes)
    {
      index = index * sizes_[place] + at[place];
    }
    return values[index];
  });
}

void PomdpxParameter::diagram(const pugi::xml_node& parameter)
{
  for (const pugi::xml_node& child : parameter.children("SubDAGTemplate"))
  {
    if (!templates_.emplace(text_.attribute(child, "id"), child).second)
    {
      text_.fail(child, "a second template of this id", "a new id");
    }
  }
  Box box(scope_.size());
  branch(text_.child(parameter, "DAG"), box, 0);
}

void PomdpxParameter::branch(const pugi::xml_node& parent, Box& box, int depth)
{
  if (depth > kMaxDepth)
  {
    text_.fail(parent, "more than " + std::to_string(kMaxDepth) + " levels",
               "a diagram that ends (does a template use itself?)");
  }
  bool found = false;
  for (const pugi::xml_node& child : parent.children())
  {
    const std::string kind = child.name();
    if (child.type() != pugi::node_element)
    {
      continue;
    }
    if (found)
    {
      text_.fail(child, "a second element in " + named(parent), "one");
    }
    found = true;
    if (kind == "Node")
    {
      node(child, box, depth);
    }
    else if (kind == "SubDAG")
    {
      shorthand(child, box, depth);
    }
    else if (kind == "Terminal")
    {
      const std::vector<XmlWord> words = XmlText::words(child);
      if (words.size() != 1)
      {
        text_.fail(child, std::to_string(words.size()) + " words", "one number");
      }
      const double value = text_.number(words.front());
      set(child, box, [value](const std::vector<std::size_t>&) { return value; });
    }
    else
    {
      text_.fail(child, named(child), "<Node>, <SubDAG> or <Terminal>");
    }
  }
  if (!found)
  {
    text_.fail(parent, "nothing in " + named(parent), "<Node>, <SubDAG> or <Terminal>");
  }
}

std::size_t PomdpxParameter::placeOf(const pugi::xml_node& element) const
{
  const std::string name = text_.attribute(element, "var");
  const auto ref = names_.find(name);
  const auto place =
      ref == names_.end() ? scope_.end() : std::find(scope_.begin(), scope_.end(), ref->second);
  if (place == scope_.end())
  {
    text_.fail(element, "the variable '" + name + "'", "one of <Parent> or <Var>");
  }
  return static_cast<std::size_t>(place - scope_.begin());
}

void PomdpxParameter::node(const pugi::xml_node& element, Box& box, int depth)
{
  const std::size_t place = placeOf(element);
  const std::optional<std::size_t> outer = box[place];
  std::set<std::size_t> edges;
  for (const pugi::xml_node& child : element.children())
  {
    if (child.type() != pugi::node_element)
    {
      continue;
    }
    if (std::string_view(child.name()) != "Edge")
    {
      text_.fail(child, named(child), "<Edge>");
    }
    const std::string name = text_.attribute(child, "val");
    const std::size_t value = valueOf({name, child.offset_debug()}, place);
    if (!edges.insert(value).second)
    {
      text_.fail(child, "a second edge for '" + name + "'", "one for each value at most");
    }
    if (!outer || *outer == value)
    {
      box[place] = value;
      branch(child, box, depth + 1);
    }
  }
  box[place] = outer;
}

void PomdpxParameter::shorthand(const pugi::xml_node& element, Box& box, int depth)
{
  const std::string type = text_.attribute(element, "type");
  if (type == "template")
  {
    const auto found = templates_.find(text_.attribute(element, "idref"));
    if (found == templates_.end())
    {
      text_.fail(element, "no template of this id", "a <SubDAGTemplate> in this <Parameter>");
    }
    branch(found->second, box, depth + 1);
    return;
  }
  const std::size_t place = placeOf(element);
  if (type == "uniform")
  {
    const double value = 1.0 / static_cast<double>(variable(place).values.size());
    set(element, box, [value](const std::vector<std::size_t>&) { return value; });
  }
  else if (type == "deterministic")
  {
    const std::string name = text_.attribute(element, "val");
    const std::size_t value = valueOf({name, element.offset_debug()}, place);
    set(element, box,
        [=](const std::vector<std::size_t>& at) { return at[place] == value ? 1.0 : 0.0; });
  }
  else if (type == "persistent")
  {
    persist(element, place, box);
  }
  else
  {
    text_.fail(element, "type '" + type + "'",
               "'deterministic', 'persistent', 'uniform' or 'template'");
  }
}

void PomdpxParameter::persist(const pugi::xml_node& element, std::size_t place, const Box& box)
{
  const VariableRef before{VariableRole::kPrevious, scope_[place].index};
  const auto found = std::find(scope_.begin(), scope_.end(), before);
  if (scope_[place].role != VariableRole::kCurrent || found == scope_.end())
  {
    text_.fail(element, "'" + variable(place).name + "' without its value before",
               "a state variable with its previous one among the parents");
  }
  const auto previous = static_cast<std::size_t>(found - scope_.begin());
  set(element, box,
      [=](const std::vector<std::size_t>& at) { return at[place] == at[previous] ? 1.0 : 0.0; });
}

}  // namespace kr3::pomdp
