#include "words.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace kr3::reasoner
{

namespace
{

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

std::string placeOf(const SourcePosition& position)
{
  return position.line == 0 ? "" : position.file + ":" + std::to_string(position.line);
}

std::string withPlace(const Record& record)
{
  const std::string place = placeOf(record.position);
  return toString(record) + (place.empty() ? "" : " (" + place + ")");
}

std::string listed(const std::vector<std::string>& items)
{
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    text += (i == 0 ? "" : i + 1 == items.size() ? " and " : ", ") + items[i];
  }
  return text;
}

std::vector<std::string> nonEmpty(const std::vector<std::string>& items)
{
  std::vector<std::string> kept;
  std::copy_if(items.begin(), items.end(), std::back_inserter(kept),
               [](const std::string& item) { return !item.empty(); });
  return kept;
}

std::string inThePast(const Literal& literal, const Description& description)
{
  const std::string& value = literal.value.name;
  const FluentDeclaration* fluent = description.findFluent(literal.atom.name);
  if (fluent != nullptr && fluent->predicate_form && value != fluent->no_value)
  {
    const Literal positive{literal.atom, literal.value, true};
    return toString(positive, description) + (literal.equal ? " was true" : " was not true");
  }
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
    return "init(" + text(head) + ", " + (value ? "true" : "false") + ")";
  }
  if (is(assumed, "exo", 2))
  {
    return toText(assumed.arguments()[0]) + " at " + toText(assumed.arguments()[1]);
  }
  if (is(assumed, "fail", 2))
  {
    return "failed(" + toText(assumed.arguments()[0]) + ", " + toText(assumed.arguments()[1]) + ")";
  }
  return "wrong(" + toString(recordOf(assumed.arguments()[0].number(), records_, beginning_)) + ")";
}

std::vector<GroundDefault> Words::defaultsAbout(const Atom& fluent) const
{
  std::vector<GroundDefault> found;
  for (const Default& rule : description_.defaults)
  {
    const Literal head = normalized(rule.head, description_);
    Binding start;
    if (unify(head.atom, fluent, start))
    {
      instances_.forEach({{}, {}, {&rule.head}, {&rule.body}}, start, [&](const Binding& binding) {
        found.push_back({&rule, toString(bound(rule.name, binding)), bound(head, binding),
                         instances_.literals(rule.body, binding)});
      });
    }
  }
  return found;
}

AssumedAction Words::assumedAction(const Clingo::Symbol& assumed) const
{
  const bool failed = is(assumed, "fail", 2);
  if (!failed && !is(assumed, "exo", 2))
  {
    return {};
  }
  return {atomOf(assumed.arguments()[0]), assumed.arguments()[1].number(), failed};
}

std::size_t Words::wrongRecord(const Clingo::Symbol& assumed) const
{
  return is(assumed, "wrong", 1) && assumed.arguments()[0].number() >= 0
             ? static_cast<std::size_t>(assumed.arguments()[0].number())
             : kNoRecord;
}

std::optional<Literal> Words::subject(const Clingo::Symbol& assumed) const
{
  if (isException(assumed))
  {
    return exception(assumed);
  }
  const std::size_t wrong = wrongRecord(assumed);
  if (wrong < records_.size())
  {
    return records_[wrong].literal;
  }
  const AssumedAction action = assumedAction(assumed);
  for (const CausalLaw& law : description_.causal_laws)
  {
    Binding binding;
    if (action.step < 0 || law.outcomes.empty() || law.outcomes.front().effects.empty() ||
        !unify(law.action, action.action, binding))
    {
      continue;
    }
    Literal changed;
    changed.atom = bound(law.outcomes.front().effects.front().fluent, binding);
    if (std::none_of(changed.atom.arguments.begin(), changed.atom.arguments.end(),
                     [](const Term& term) { return term.is_variable; }))
    {
      return changed;
    }
  }
  return std::nullopt;
}

bool Words::isException(const Clingo::Symbol& assumed) const
{
  return is(assumed, "no", 2) || is(assumed, "yes", 2);
}

std::vector<GroundDefault> Words::exceptedDefaults(const Clingo::Symbol& assumed) const
{
  const Atom fluent = atomOf(assumed.arguments()[0]);
  const std::string value = toText(assumed.arguments()[1]);
  std::vector<GroundDefault> excepted;
  for (const Default& rule : description_.defaults)
  {
    const Literal head = normalized(rule.head, description_);
    Binding start;
    const bool fits =
        head.equal == is(assumed, "no", 2) && unify(head.atom, fluent, start) &&
        (head.value.is_variable ? start.emplace(head.value.name, value).first->second == value
                                : head.value.name == value);
    if (fits)
    {
      instances_.forEach({{}, {}, {&rule.head}, {&rule.body}}, start, [&](const Binding& binding) {
        excepted.push_back({&rule, toString(bound(rule.name, binding)), bound(head, binding),
                            instances_.literals(rule.body, binding)});
      });
    }
  }
  return excepted;
}

std::string Words::sentence(const Clingo::Symbol& assumed) const
{
  if (is(assumed, "no", 2) || is(assumed, "yes", 2))
  {
    std::string text;
    std::string last;
    for (const GroundDefault& instance : exceptedDefaults(assumed))
    {
      const std::size_t open = instance.name.find('(');
      const std::string rule = instance.name.substr(0, open);
      const std::string who = open == std::string::npos
                                  ? "there"
                                  : instance.name.substr(open + 1, instance.name.size() - open - 2);
      const std::string excepted = who + " is an exception to default " + rule;
      if (excepted != last)  // instances may differ in variables that the name does not have
      {
        text += (text.empty() ? "" : " and ") + excepted;
      }
      last = excepted;
    }
    return text + ": initially " + inThePast(exception(assumed), description_);
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
  const int number = assumed.arguments()[0].number();
  return "the record " + withPlace(recordOf(number, records_, beginning_)) + " is wrong";
}

Assumption Words::assumption(const Clingo::Symbol& assumed) const
{
  Assumption assumption;
  assumption.statement = statement(assumed);
  assumption.sentence = sentence(assumed);
  if (is(assumed, "wrong", 1))
  {
    assumption.kind = AssumptionKind::kWrongRecord;
    assumption.price = doubtOf(recordOf(assumed.arguments()[0].number(), records_, beginning_));
    return assumption;
  }
  if (is(assumed, "exo", 2) || is(assumed, "fail", 2))
  {
    assumption.kind = is(assumed, "exo", 2) ? AssumptionKind::kExogenous : AssumptionKind::kFailure;
    assumption.price = options_.exogenous_weight;
    return assumption;
  }
  for (const GroundDefault& instance : exceptedDefaults(assumed))
  {
    const auto weight = options_.default_weights.find(instance.rule->name.name);
    const int price =
        weight == options_.default_weights.end() ? options_.exception_weight : weight->second;
    assumption.price = assumption.defaults.empty() ? price : std::min(assumption.price, price);
    if (assumption.defaults.empty() || assumption.defaults.back() != instance.name)
    {
      assumption.defaults.push_back(instance.name);
    }
  }
  return assumption;
}

}  // namespace kr3::reasoner
