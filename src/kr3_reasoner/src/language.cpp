#include "kr3_reasoner/language.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "builder.hpp"
#include "check.hpp"
#include "grammar.hpp"
#include "ground_phrases.hpp"
#include "predicate_form.hpp"
#include "refinement_signature.hpp"
#include "text.hpp"
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

void append(std::vector<Diagnostic>& problems, std::vector<Diagnostic> more)
{
  problems.insert(problems.end(), std::make_move_iterator(more.begin()),
                  std::make_move_iterator(more.end()));
}

void checkFormula(const Formula& formula, const Symbols& symbols, std::vector<Diagnostic>& problems)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    append(problems, checkGround(formula.literal, symbols));
  }
  for (const Formula& operand : formula.operands)
  {
    checkFormula(operand, symbols, problems);
  }
}

/// Parses a phrase that is not part of a file; `what` stands for the file's name in messages.
grammar::Node parsePhrase(grammar::Kind kind, const std::string& text, const std::string& what)
{
  std::vector<Diagnostic> problems;
  checkBytes(text, what, problems);
  throwIfAny(problems);
  grammar::Node node = grammar::parse(kind, text, {what, 1, 1}, problems);
  throwIfAny(problems);
  return node;
}

/// The name of a phrase in messages.
std::string quoted(const std::string& text)
{
  constexpr std::size_t kLongest = 80;
  return text.size() <= kLongest ? "'" + text + "'" : "'" + text.substr(0, kLongest) + "...'";
}

/// A magnified sort must be the whole value sort of what it stands in.
void checkPartialFunctions(const Description& refinement, const Description& base,
                           std::vector<Diagnostic>& problems)
{
  for (const Magnification& magnification : refinement.magnifications)
  {
    for (const FluentDeclaration& fluent : base.fluents)
    {
      const Sort* values = fluent.value_sort ? base.findSort(*fluent.value_sort) : nullptr;
      if (!fluent.no_value.empty() && values != nullptr &&
          values->member_sorts.front() == magnification.coarse)
      {
        problems.push_back({magnification.position,
                            "found the magnified sort " + magnification.coarse + " in " +
                                fluent.name + ", which may have no value, expected 'total " +
                                fluent.name + ".' in " + fluent.position.file});
      }
    }
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
  Builder builder("", nullptr);
  std::vector<std::string> files;
  for (const SourceText& source : sources)
  {
    builder.read(source.text, source.file);
    files.push_back(source.file);
  }
  Description description = builder.finish();
  std::vector<Diagnostic> problems = std::move(builder.problems);
  for (const Magnification& magnification : description.magnifications)
  {
    problems.push_back({magnification.position,
                        "found 'magnify' in a description, expected it in a refinement only"});
  }
  rewritePredicateForm(description, nullptr, builder.totalities, problems);
  append(problems, check(description));
  throwIfAny(std::move(problems), files);
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
  builder.read(text, file);
  Description refinement = builder.finish();
  std::vector<Diagnostic> problems = std::move(builder.problems);
  for (const AspBlock& block : refinement.asp_blocks)
  {
    problems.push_back(
        {block.position, "found asp code in a refinement, expected it in a description only"});
  }
  if (!base.asp_blocks.empty())
  {
    const SourcePosition& code = base.asp_blocks.front().position;
    problems.push_back({{file, 1, 1},
                        "found asp code in the description, " + code.file + ":" +
                            std::to_string(code.line) +
                            ", expected none: nothing says what it means at the low level"});
  }
  rewritePredicateForm(refinement, &base, builder.totalities, problems);
  checkPartialFunctions(refinement, base, problems);
  Description merged = fineSignature(refinement, base, problems);
  append(problems, check(merged));
  throwIfAny(std::move(problems));
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

Literal parseGroundLiteral(const std::string& text, const Symbols& symbols)
{
  const grammar::Node node = parsePhrase(grammar::Kind::kGroundLiteral, text, quoted(text));
  Builder builder(quoted(text), &symbols.description());
  Literal literal = builder.literal(node);
  throwIfAny(std::move(builder.problems));
  throwIfAny(checkGround(literal, symbols));
  return literal;
}

Literal parseGroundLiteral(const std::string& text, const Description& description)
{
  return parseGroundLiteral(text, Symbols(description));
}

Atom parseGroundAction(const std::string& text, const Symbols& symbols)
{
  const grammar::Node node = parsePhrase(grammar::Kind::kGroundAction, text, quoted(text));
  Builder builder(quoted(text), &symbols.description());
  Atom action = builder.atom(node);
  throwIfAny(std::move(builder.problems));
  throwIfAny(checkGroundAction(action, symbols));
  return action;
}

Atom parseGroundAction(const std::string& text, const Description& description)
{
  return parseGroundAction(text, Symbols(description));
}

Formula parseGoal(const std::string& text, const Description& description)
{
  const grammar::Node node = parsePhrase(grammar::Kind::kGoal, text, "goal");
  Builder builder("goal", &description);
  Formula formula = builder.formula(node);
  throwIfAny(builder.problems);
  std::vector<Diagnostic> problems;
  checkFormula(formula, Symbols(description), problems);
  throwIfAny(std::move(problems));
  return formula;
}

}  // namespace kr3::reasoner
