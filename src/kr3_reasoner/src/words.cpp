#include "words.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

namespace kr3::reasoner
{

namespace
{

using Binding = std::map<std::string, std::string>;

Atom atomOf(const Clingo::Symbol& symbol)
{
  Atom atom;
  if (symbol.type() != Clingo::SymbolType::Function)
  {
    atom.name = symbol.to_string();
    return atom;
  }
  atom.name = symbol.name();
  for (const Clingo::Symbol& argument : symbol.arguments())
  {
    atom.arguments.push_back({false, toText(argument)});
  }
  return atom;
}

bool match(const Term& open, const std::string& constant, Binding& binding)
{
  return open.is_variable ? binding.emplace(open.name, constant).first->second == constant
                          : open.name == constant;
}

bool is(const Clingo::Symbol& symbol, const char* name, std::size_t arity)
{
  return symbol.type() == Clingo::SymbolType::Function && std::string_view(symbol.name()) == name &&
         symbol.arguments().size() == arity;
}

}  // namespace

std::string withoutSpaces(const std::string& text)
{
  std::string kept = text;
  kept.erase(std::remove_if(kept.begin(), kept.end(),
                            [](char c) { return c == ' ' || c == '\t' || c == '\n'; }),
             kept.end());
  return kept;
}

std::string inThePast(const Literal& literal)
{
  const std::string& value = literal.value.name;
  const bool boolean = value == "true" || value == "false";
  const bool negative = (value == "false") == literal.equal && (boolean || !literal.equal);
  return toString(literal.atom) + " was " + (negative ? "not " : "") + (boolean ? "true" : value);
}

Literal Words::exception(const Clingo::Symbol& assumed) const
{
  const Literal head{atomOf(assumed.arguments()[0]),
                     {false, toText(assumed.arguments()[1])},
                     is(assumed, "no", 2)};
  return contrary(head, description_);
}

std::string Words::statement(const Clingo::Symbol& assumed) const
{
  if (is(assumed, "no", 2) || is(assumed, "yes", 2))
  {
    Literal head{atomOf(assumed.arguments()[0]), {false, toText(assumed.arguments()[1])}, true};
    bool value = is(assumed, "yes", 2);
    if (head.value.name == "false")
    {
      head.value.name = "true";
      value = !value;
    }
    return "init(" + toString(head) + ", " + (value ? "true" : "false") + ")";
  }
  if (is(assumed, "exo", 2))
  {
    return toText(assumed.arguments()[0]) + " at " + toText(assumed.arguments()[1]);
  }
  if (is(assumed, "fail", 2))
  {
    return "failed(" + toText(assumed.arguments()[0]) + ", " + toText(assumed.arguments()[1]) + ")";
  }
  const auto index = static_cast<std::size_t>(assumed.arguments()[0].number());
  return "wrong(" + toString(records_[index].record) + ")";
}

std::string Words::exceptedDefaults(const Clingo::Symbol& assumed) const
{
  const Atom fluent = atomOf(assumed.arguments()[0]);
  const std::string value = toText(assumed.arguments()[1]);
  std::string text;
  for (const Default& rule : description_.defaults)
  {
    const Literal head = normalized(rule.head, description_);
    Binding binding;
    bool fits = head.atom.name == fluent.name && head.equal == is(assumed, "no", 2) &&
                match(head.value, value, binding);
    for (std::size_t i = 0; fits && i < fluent.arguments.size(); ++i)
    {
      fits = match(head.atom.arguments[i], fluent.arguments[i].name, binding);
    }
    for (const Condition& condition : rule.body)
    {
      const auto* membership = std::get_if<Membership>(&condition);
      const auto bound =
          membership == nullptr ? binding.end() : binding.find(membership->term.name);
      if (bound != binding.end())
      {
        const auto& elements = description_.findSort(membership->sort)->elements;
        const bool in =
            std::find(elements.begin(), elements.end(), bound->second) != elements.end();
        fits = fits && in != membership->negated;
      }
    }
    if (!fits)
    {
      continue;
    }
    std::string who;
    for (const Term& argument : rule.name.arguments)
    {
      const auto bound = argument.is_variable ? binding.find(argument.name) : binding.end();
      who += (who.empty() ? "" : ", ") + (bound == binding.end() ? argument.name : bound->second);
    }
    text += (text.empty() ? "" : " and ") + (who.empty() ? "there" : who) +
            " is an exception to default " + rule.name.name;
  }
  return text;
}

std::string Words::sentence(const Clingo::Symbol& assumed) const
{
  if (is(assumed, "no", 2) || is(assumed, "yes", 2))
  {
    return exceptedDefaults(assumed) + ": initially " + inThePast(exception(assumed));
  }
  if (is(assumed, "exo", 2))
  {
    return "somebody or something else did " + toText(assumed.arguments()[0]) + " at step " +
           toText(assumed.arguments()[1]);
  }
  if (is(assumed, "fail", 2))
  {
    return "the action " + toText(assumed.arguments()[0]) + " at step " +
           toText(assumed.arguments()[1]) + " failed";
  }
  const auto index = static_cast<std::size_t>(assumed.arguments()[0].number());
  return "the record " + toString(records_[index].record) + " is wrong";
}

}  // namespace kr3::reasoner
