#include "kr3_reasoner/language.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include <kr3_common/error.hpp>

#include "builder.hpp"
#include "check.hpp"
#include "grammar.hpp"
#include "text_file.hpp"

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

template <typename Item>
void append(std::vector<Item>&& from, std::vector<Item>& to)
{
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

/// Adds the statements of one file to those of others.
void append(Description&& from, Description& to)
{
  append(std::move(from.sorts), to.sorts);
  append(std::move(from.fluents), to.fluents);
  append(std::move(from.actions), to.actions);
  append(std::move(from.causal_laws), to.causal_laws);
  append(std::move(from.constraints), to.constraints);
  append(std::move(from.executabilities), to.executabilities);
  append(std::move(from.observations), to.observations);
  append(std::move(from.static_facts), to.static_facts);
  append(std::move(from.defaults), to.defaults);
  append(std::move(from.preferences), to.preferences);
  append(std::move(from.costs), to.costs);
  append(std::move(from.magnifications), to.magnifications);
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

Description parseDescription(const std::vector<SourceText>& sources)
{
  Description names;  // of all files, so that each may use them
  for (const SourceText& source : sources)
  {
    if (sources.size() > 1)
    {
      append(Builder(source.file, nullptr).build(source.text), names);
    }
  }
  Description description;
  std::vector<Diagnostic> problems;
  for (const SourceText& source : sources)
  {
    Builder builder(source.file, sources.size() > 1 ? &names : nullptr);
    append(builder.build(source.text), description);
    problems.insert(problems.end(), builder.problems.begin(), builder.problems.end());
  }
  for (const Magnification& magnification : description.magnifications)
  {
    problems.push_back({magnification.position,
                        "found 'magnify' in a description, expected it in a refinement only"});
  }
  const std::vector<Diagnostic> found = check(description);
  problems.insert(problems.end(), found.begin(), found.end());
  const auto fileIndex = [&](const Diagnostic& problem) {
    return std::find_if(sources.begin(), sources.end(), [&](const SourceText& source) {
      return source.file == problem.position.file;
    });
  };
  std::stable_sort(problems.begin(), problems.end(), [&](const Diagnostic& a, const Diagnostic& b) {
    return std::make_tuple(fileIndex(a), a.position.line, a.position.column) <
           std::make_tuple(fileIndex(b), b.position.line, b.position.column);
  });
  throwIfAny(problems);
  return description;
}

Description parseDescription(const std::string& text, const std::string& file)
{
  return parseDescription(std::vector<SourceText>{{file, text}});
}

Description readDescription(const std::vector<std::string>& paths)
{
  std::vector<SourceText> sources;
  for (const std::string& path : paths)
  {
    sources.push_back({path, readTextFile(path)});
  }
  return parseDescription(sources);
}

Description readDescription(const std::string& path)
{
  return readDescription(std::vector<std::string>{path});
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

Description readRefinement(const std::string& path, const Description& base)
{
  return parseRefinement(readTextFile(path), path, base);
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
