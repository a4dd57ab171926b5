#include <algorithm>
#include <set>
#include <sstream>

#include "kr3_reasoner/language.hpp"
#include "print_text.hpp"

namespace kr3::reasoner
{

namespace
{

std::string conditionText(const Condition& condition, const Description& description)
{
  if (const auto* literal = std::get_if<Literal>(&condition))
  {
    return toString(*literal, description);
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    return comparison->left.name + " " + toString(comparison->op) + " " + comparison->right.name;
  }
  const auto& membership = std::get<Membership>(condition);
  return (membership.negated ? "not " : "") + membership.sort + "(" + membership.term.name + ")";
}

std::string bodyText(const Body& body, const Description& description)
{
  std::vector<std::string> parts;
  for (const Condition& condition : body)
  {
    parts.push_back(conditionText(condition, description));
  }
  return joined(parts, ", ");
}

std::string ifText(const Body& body, const Description& description)
{
  return body.empty() ? "" : " if " + bodyText(body, description);
}

std::string outcomeText(const Outcome& outcome, const Description& description)
{
  std::vector<std::string> effects;
  for (const Effect& effect : outcome.effects)
  {
    effects.push_back(effect.is_choice
                          ? toString(effect.fluent) + " = {" + effect.value.name + " : " +
                                bodyText(effect.choice, description) + "}"
                          : toString(Literal{effect.fluent, effect.value, true}, description));
  }
  return (effects.empty() ? "nothing" : joined(effects, ", ")) +
         (outcome.label.empty() ? "" : " [" + outcome.label + "]");
}

/// The sort of the last argument of a fluent in the predicate form.
std::string lastSort(const FluentDeclaration& fluent, const Description& description)
{
  const Sort* values = description.findSort(*fluent.value_sort);
  return fluent.no_value.empty() || values == nullptr ? *fluent.value_sort
                                                      : values->member_sorts.front();
}

std::string fluentText(const FluentDeclaration& fluent, const Description& description)
{
  if (fluent.predicate_form)
  {
    std::vector<std::string> sorts = fluent.argument_sorts;
    sorts.push_back(lastSort(fluent, description));
    return signature(fluent.name, sorts);
  }
  return signature(fluent.name, fluent.argument_sorts) +
         (fluent.value_sort ? " : " + *fluent.value_sort : "");
}

/// `-loc(X1, Y1) if loc(X1, Y2), Y1 != Y2`, which makes a predicate a function.
std::string exclusionLaw(const FluentDeclaration& fluent)
{
  std::vector<std::string> variables;
  for (std::size_t i = 0; i < fluent.argument_sorts.size(); ++i)
  {
    variables.push_back("X" + std::to_string(i + 1));
  }
  std::vector<std::string> other = variables;
  variables.emplace_back("Y1");
  other.emplace_back("Y2");
  return "-" + signature(fluent.name, variables) + " if " + signature(fluent.name, other) +
         ", Y1 != Y2";
}

std::string sortText(const Sort& sort, const Description& description)
{
  std::set<std::string> inherited;
  for (const std::string& member : sort.member_sorts)
  {
    if (const Sort* found = description.findSort(member))
    {
      inherited.insert(found->elements.begin(), found->elements.end());
    }
  }
  std::vector<std::string> own;
  std::copy_if(sort.elements.begin(), sort.elements.end(), std::back_inserter(own),
               [&](const std::string& element) { return inherited.count(element) == 0; });
  std::vector<std::string> parts;
  if (!own.empty() || sort.member_sorts.empty())
  {
    parts.push_back("{" + joined(own, ", ") + "}");
  }
  parts.insert(parts.end(), sort.member_sorts.begin(), sort.member_sorts.end());
  return sort.name + " = " + joined(parts, " + ");
}

const char* kindText(FluentKind kind)
{
  switch (kind)
  {
    case FluentKind::kStatic:
      return "";
    case FluentKind::kInertial:
      return "inertial ";
    case FluentKind::kDefined:
      return "defined ";
    case FluentKind::kKnowledge:
      return "knowledge ";
  }
  return "";
}

/// Prints sections; an empty one is left out.
class Printer
{
public:
  void section(const std::string& name) { pending_ = name; }

  void statement(const std::string& text)
  {
    if (!pending_.empty())
    {
      text_ << (text_.tellp() > 0 ? "\n" : "") << pending_ << "\n";
      pending_.clear();
    }
    text_ << "  " << text << ".\n";
  }

  void raw(const std::string& section, const std::string& text)
  {
    text_ << (text_.tellp() > 0 ? "\n" : "") << section << "\n" << text << "\n";
    pending_.clear();
  }

  [[nodiscard]] std::string text() const { return text_.str(); }

private:
  std::ostringstream text_;
  std::string pending_;
};

void printDeclarations(const Description& description, Printer& printer)
{
  for (const Magnification& magnification : description.magnifications)
  {
    printer.statement("magnify " + magnification.coarse + " into " + magnification.fine + " by " +
                      magnification.component_static);
  }
  printer.section("sorts");
  std::set<std::string> made;  // by the checks, for partial functions
  for (const FluentDeclaration& fluent : description.fluents)
  {
    if (!fluent.no_value.empty())
    {
      made.insert(*fluent.value_sort);
    }
  }
  for (const Sort& sort : description.sorts)
  {
    if (made.count(sort.name) == 0)
    {
      printer.statement(sortText(sort, description));
    }
  }
  for (const bool statics : {true, false})
  {
    printer.section(statics ? "statics" : "fluents");
    for (const FluentDeclaration& fluent : description.fluents)
    {
      if ((fluent.kind == FluentKind::kStatic) == statics)
      {
        printer.statement(kindText(fluent.kind) + fluentText(fluent, description));
      }
    }
  }
  printer.section("actions");
  for (const ActionDeclaration& action : description.actions)
  {
    printer.statement((action.exogenous ? "exogenous " : "") +
                      signature(action.name, action.argument_sorts));
  }
}

void printAxioms(const Description& description, Printer& printer)
{
  printer.section("axioms");
  for (const CausalLaw& law : description.causal_laws)
  {
    std::vector<std::string> outcomes;
    for (const Outcome& outcome : law.outcomes)
    {
      outcomes.push_back(outcomeText(outcome, description));
    }
    printer.statement(toString(law.action) + " causes " + joined(outcomes, " or ") +
                      ifText(law.body, description));
  }
  for (const FluentDeclaration& fluent : description.fluents)
  {
    if (fluent.predicate_form)
    {
      printer.statement(exclusionLaw(fluent));
      if (fluent.no_value.empty())
      {
        printer.statement("total " + fluent.name);
      }
    }
  }
  for (const StateConstraint& constraint : description.constraints)
  {
    printer.statement((constraint.head ? toString(*constraint.head, description) : "false") +
                      ifText(constraint.body, description));
  }
  for (const Executability& rule : description.executabilities)
  {
    std::vector<std::string> actions;
    for (const auto& action : rule.actions)
    {
      const auto* atom = std::get_if<Atom>(&action);
      actions.push_back(atom != nullptr ? toString(*atom) : toString(std::get<Term>(action)));
    }
    printer.statement("impossible " + joined(actions, ", ") + ifText(rule.body, description));
  }
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(15);
  text << value;
  return text.str();
}

/// What an action tells about: `loc(O) = P`, `loc(O, P)`, or `in_hand(R, O) = true`.
std::string observedText(const ObservationLaw& law, const Description& description)
{
  const FluentDeclaration* fluent = description.findFluent(law.fluent.name);
  return fluent != nullptr && fluent->predicate_form
             ? toString(Literal{law.fluent, *law.value, true}, description)
             : toString(law.fluent) + " = " + law.value->name;
}

void printAsp(const Description& description, Printer& printer)
{
  for (const AspBlock& block : description.asp_blocks)
  {
    printer.raw(block.part == AspPart::kBase    ? "asp"
                : block.part == AspPart::kState ? "asp state"
                                                : "asp transition",
                block.text);
  }
}

void printRest(const Description& description, Printer& printer)
{
  printer.section("observations");
  for (const ObservationLaw& law : description.observations)
  {
    printer.statement(toString(law.action) + " observes " +
                      (law.value ? observedText(law, description) : toString(law.fluent)));
  }
  printer.section("facts");
  for (const Literal& fact : description.static_facts)
  {
    printer.statement(toString(fact, description));
  }
  printer.section("defaults");
  for (const Default& rule : description.defaults)
  {
    printer.statement(toString(rule.name) + ": " + toString(rule.head, description) +
                      ifText(rule.body, description));
  }
  for (const Preference& preference : description.preferences)
  {
    printer.statement("prefer " + toString(preference.better) + " over " +
                      toString(preference.worse));
  }
  for (const ActionCost& cost : description.costs)
  {
    printer.statement("cost " + toString(cost.action) + " = " + number(cost.cost) +
                      ifText(cost.body, description));
  }
  printAsp(description, printer);
}

}  // namespace

std::string toString(const Description& description)
{
  Printer printer;
  printDeclarations(description, printer);
  printAxioms(description, printer);
  printRest(description, printer);
  return printer.text();
}

}  // namespace kr3::reasoner
