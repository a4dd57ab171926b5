#include "kr3_reasoner/language.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>
#include <utility>

#include <kr3_common/error.hpp>

#include "builder.hpp"
#include "check.hpp"
#include "grammar.hpp"

namespace kr3::reasoner
{

namespace
{

template <typename Declaration>
const Declaration* find(const std::vector<Declaration>& declarations, const std::string& name)
{
  const auto found =
      std::find_if(declarations.begin(), declarations.end(),
                   [&](const Declaration& declaration) { return declaration.name == name; });
  return found == declarations.end() ? nullptr : &*found;
}

SourcePosition startOf(const std::string& what)
{
  return {what, 1, 1};
}

/// The signature that a refinement's axioms use: the base's, with each magnified sort replaced by
/// its components, and a component of each coarse element where the refinement does not name any.
Description fineSignature(const Description& refinement, const Description& base)
{
  Description merged = refinement;
  std::map<std::string, std::string> fine_of;
  for (const Sort& sort : base.sorts)
  {
    merged.sorts.push_back(sort);
  }
  for (const Magnification& magnification : refinement.magnifications)
  {
    fine_of[magnification.coarse] = magnification.fine;
    if (merged.findSort(magnification.fine) == nullptr)
    {
      merged.sorts.push_back(
          {magnification.fine, {"some_" + magnification.fine}, {}, magnification.position});
    }
    if (merged.findFluent(magnification.component_static) == nullptr)
    {
      merged.fluents.push_back({magnification.component_static,
                                FluentKind::kStatic,
                                {magnification.fine},
                                magnification.coarse,
                                magnification.position});
    }
  }
  const auto refine = [&](std::string& sort) {
    const auto found = fine_of.find(sort);
    if (found != fine_of.end())
    {
      sort = found->second;
    }
  };
  for (FluentDeclaration fluent : base.fluents)
  {
    std::for_each(fluent.argument_sorts.begin(), fluent.argument_sorts.end(), refine);
    if (fluent.value_sort)
    {
      refine(*fluent.value_sort);
    }
    merged.fluents.push_back(std::move(fluent));
  }
  for (ActionDeclaration action : base.actions)
  {
    std::for_each(action.argument_sorts.begin(), action.argument_sorts.end(), refine);
    merged.actions.push_back(std::move(action));
  }
  return merged;
}

template <typename Check, typename Value>
Value checked(Value value, const std::vector<Diagnostic>& problems, Check check)
{
  throwIfAny(problems);
  throwIfAny(check(value));
  return value;
}

void checkFormula(const Formula& formula, const Description& description,
                  std::vector<Diagnostic>& problems)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    const auto found = checkGround(formula.literal, description);
    problems.insert(problems.end(), found.begin(), found.end());
  }
  for (const Formula& operand : formula.operands)
  {
    checkFormula(operand, description, problems);
  }
}

}  // namespace

const Sort* Description::findSort(const std::string& name) const
{
  return find(sorts, name);
}

const FluentDeclaration* Description::findFluent(const std::string& name) const
{
  return find(fluents, name);
}

const ActionDeclaration* Description::findAction(const std::string& name) const
{
  return find(actions, name);
}

Description parseDescription(const std::string& text, const std::string& file)
{
  Builder builder(file, nullptr);
  Description description = builder.build(text);
  std::vector<Diagnostic> problems = std::move(builder.problems);
  for (const Magnification& magnification : description.magnifications)
  {
    problems.push_back({magnification.position,
                        "found 'magnify' in a description, expected it in a refinement only"});
  }
  const std::vector<Diagnostic> found = check(description);
  problems.insert(problems.end(), found.begin(), found.end());
  std::stable_sort(problems.begin(), problems.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.position.line, a.position.column) <
           std::tie(b.position.line, b.position.column);
  });
  throwIfAny(problems);
  return description;
}

Description readDescription(const std::string& path)
{
  std::ifstream stream(path);
  if (!stream)
  {
    throw NotFound("cannot read the description '" + path + "'");
  }
  std::stringstream text;
  text << stream.rdbuf();
  return parseDescription(text.str(), path);
}

Description parseRefinement(const std::string& text, const std::string& file,
                            const Description& base)
{
  Builder builder(file, &base);
  Description refinement = builder.build(text);
  std::vector<Diagnostic> problems = std::move(builder.problems);
  Description merged = fineSignature(refinement, base);
  const std::vector<Diagnostic> found = check(merged);
  problems.insert(problems.end(), found.begin(), found.end());
  std::stable_sort(problems.begin(), problems.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.position.line, a.position.column) <
           std::tie(b.position.line, b.position.column);
  });
  throwIfAny(problems);
  for (Sort& sort : refinement.sorts)
  {
    sort.elements = merged.findSort(sort.name)->elements;
  }
  return refinement;
}

void checkDescription(Description& description)
{
  throwIfAny(check(description));
}

Literal parseGroundLiteral(const std::string& text, const Description& description)
{
  std::vector<Diagnostic> problems;
  Builder builder("literal", &description);
  const grammar::Node node =
      grammar::parse(grammar::Kind::kGroundLiteral, text, startOf("'" + text + "'"), problems);
  throwIfAny(problems);
  Literal literal = builder.literal(node);
  return checked(std::move(literal), builder.problems,
                 [&](const Literal& value) { return checkGround(value, description); });
}

Atom parseGroundAction(const std::string& text, const Description& description)
{
  std::vector<Diagnostic> problems;
  const grammar::Node node =
      grammar::parse(grammar::Kind::kGroundAction, text, startOf("'" + text + "'"), problems);
  throwIfAny(problems);
  return checked(Builder::atom(node), problems,
                 [&](const Atom& value) { return checkGroundAction(value, description); });
}

Formula parseGoal(const std::string& text, const Description& description)
{
  std::vector<Diagnostic> problems;
  Builder builder("goal", &description);
  const grammar::Node node = grammar::parse(grammar::Kind::kGoal, text, startOf("goal"), problems);
  throwIfAny(problems);
  Formula formula = builder.formula(node);
  throwIfAny(builder.problems);
  checkFormula(formula, description, problems);
  throwIfAny(problems);
  return formula;
}

}  // namespace kr3::reasoner
