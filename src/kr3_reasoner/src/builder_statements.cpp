#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "builder.hpp"
#include "predicate_form.hpp"
#include "text.hpp"

namespace kr3::reasoner
{

using grammar::Node;
using grammar::Rule;

namespace
{

std::optional<grammar::Kind> kindOf(const std::string& section)
{
  static const std::map<std::string, grammar::Kind> kKinds = {
      {"sorts", grammar::Kind::kSort},       {"statics", grammar::Kind::kStatic},
      {"fluents", grammar::Kind::kFluent},   {"actions", grammar::Kind::kAction},
      {"axioms", grammar::Kind::kAxiom},     {"observations", grammar::Kind::kObservation},
      {"defaults", grammar::Kind::kDefault}, {"facts", grammar::Kind::kFact},
  };
  const auto found = kKinds.find(section);
  return found == kKinds.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> parametersOf(const Node& node)
{
  std::vector<std::string> sorts;
  if (const Node* parameters = node.child(Rule::kParameters))
  {
    for (const Node& sort : parameters->children)
    {
      sorts.push_back(nameOf(sort));
    }
  }
  return sorts;
}

}  // namespace

Sort Builder::sort(const Node& node)
{
  constexpr long kMaxRange = 100000;
  Sort sort;
  sort.name = nameOf(node);
  sort.position = position(node);
  for (const Node& part : node.children)
  {
    if (part.rule == Rule::kSortName)
    {
      sort.member_sorts.push_back(nameOf(part));
    }
    else if (part.rule == Rule::kSet)
    {
      for (const Node& element : part.children)
      {
        sort.elements.push_back(term(element).name);
      }
    }
    else if (part.rule == Rule::kRange)
    {
      const long first = std::stol(number(part.children[0]));
      const long last = std::stol(number(part.children[1]));
      if (last < first || last - first >= kMaxRange)
      {
        report(part, "found the range " + std::to_string(first) + ".." + std::to_string(last) +
                         ", expected a first number that is not above the last, and at most " +
                         std::to_string(kMaxRange) + " numbers");
        continue;
      }
      if (num_elements_ + static_cast<std::size_t>(last - first) > kMaxElements)
      {
        report(part, "found more than " + std::to_string(kMaxElements) +
                         " elements in the sets and ranges of the file, expected fewer");
        continue;
      }
      for (long number = first; number <= last; ++number)
      {
        sort.elements.push_back(std::to_string(number));
      }
      num_elements_ += static_cast<std::size_t>(last - first);
    }
  }
  return sort;
}

Effect Builder::effect(const Node& node)
{
  Effect effect;
  effect.fluent = atom(*node.child(Rule::kAtom));
  effect.value = {false, node.child(Rule::kMinus) != nullptr ? "false" : "true"};
  const Node& last = node.children.back();
  if (isTerm(last))
  {
    effect.value = term(last);
  }
  else if (last.rule == Rule::kChoice)
  {
    effect.is_choice = true;
    effect.value = term(*last.child(Rule::kVariable));
    effect.choice = body(last);
  }
  return effect;
}

void Builder::addExecutability(const Node& node)
{
  Executability rule;
  rule.position = position(node);
  for (const Node& part : node.children)
  {
    if (part.rule == Rule::kAtom)
    {
      rule.actions.emplace_back(atom(part));
    }
    else if (part.rule == Rule::kVariable)
    {
      rule.actions.emplace_back(term(part));
    }
  }
  rule.body = body(node);
  description_.executabilities.push_back(std::move(rule));
}

void Builder::addCausalLaw(const Node& node)
{
  CausalLaw law{atom(node.children.front()), {}, body(node), position(node)};
  for (const Node& part : node.children)
  {
    if (part.rule != Rule::kOutcome)
    {
      continue;
    }
    Outcome outcome;
    for (const Node& piece : part.children)
    {
      if (piece.rule == Rule::kEffect)
      {
        outcome.effects.push_back(effect(piece));
      }
      else if (piece.rule == Rule::kLabel)
      {
        outcome.label = nameOf(piece);
      }
    }
    law.outcomes.push_back(std::move(outcome));
  }
  description_.causal_laws.push_back(std::move(law));
}

void Builder::addConstraint(const Node& node)
{
  StateConstraint constraint{std::nullopt, body(node), position(node)};
  if (const Node* head = node.child(Rule::kCondition))
  {
    constraint.head = literal(*head);
  }
  description_.constraints.push_back(std::move(constraint));
}

void Builder::addStatement(const Node& node)
{
  switch (node.rule)
  {
    case Rule::kImpossible:
      addExecutability(node);
      break;
    case Rule::kCausalLaw:
      addCausalLaw(node);
      break;
    case Rule::kConstraint:
      addConstraint(node);
      break;
    case Rule::kObservationLaw:
    {
      ObservationLaw law{atom(node.children[0]), atom(node.children[1]), std::nullopt,
                         position(node)};
      if (node.children.size() > 2)
      {
        law.value = term(node.children[2]);
      }
      description_.observations.push_back(std::move(law));
      break;
    }
    case Rule::kDefault:
      description_.defaults.push_back({atom(*node.child(Rule::kAtom)),
                                       literal(*node.child(Rule::kCondition)), body(node),
                                       position(node)});
      break;
    case Rule::kFact:
      description_.static_facts.push_back(literal(node));
      break;
    case Rule::kMagnification:
      description_.magnifications.push_back({nameOf(node.children[0]), nameOf(node.children[1]),
                                             std::string(node.children[2].text), position(node)});
      break;
    case Rule::kPreference:
      description_.preferences.push_back(
          {atom(node.children[0]), atom(node.children[1]), position(node)});
      break;
    case Rule::kCost:
      description_.costs.push_back({atom(*node.child(Rule::kAtom)),
                                    decimal(*node.child(Rule::kDecimal)), body(node),
                                    position(node)});
      break;
    case Rule::kTotality:
      totalities.push_back({nameOf(node), position(node)});
      break;
    default:
      break;
  }
}

void Builder::declare(const Node& node, const std::string& section)
{
  if (node.rule == Rule::kSortDeclaration)
  {
    description_.sorts.push_back(sort(node));
    sorts_.insert(description_.sorts.back().name);
  }
  else if (node.rule == Rule::kActionDeclaration)
  {
    description_.actions.push_back({nameOf(node), parametersOf(node),
                                    node.child(Rule::kExogenous) != nullptr, position(node)});
  }
  else
  {
    FluentDeclaration fluent{nameOf(node), FluentKind::kStatic, parametersOf(node), std::nullopt,
                             position(node)};
    if (section == "fluents")
    {
      const std::string_view kind = node.child(Rule::kFluentKind)->text;
      fluent.kind = kind == "inertial"  ? FluentKind::kInertial
                    : kind == "defined" ? FluentKind::kDefined
                                        : FluentKind::kKnowledge;
    }
    if (const Node* value = node.child(Rule::kValueSort))
    {
      const std::string sort = nameOf(value->children[0]);
      fluent.value_sort = sort == "boolean" ? std::nullopt : std::optional(sort);
    }
    fluents_.insert(fluent.name);
    description_.fluents.push_back(std::move(fluent));
  }
}

void Builder::read(std::string_view text, const std::string& file)
{
  file_ = file;
  checkBytes(text, file_, problems);
  for (const Chunk& chunk : split(text))
  {
    const SourcePosition start{file_, chunk.line, chunk.column};
    if (isAspSection(chunk.section))
    {
      // Its text begins with the line after the header.
      std::string code(chunk.text.substr(std::min(chunk.text.find('\n') + 1, chunk.text.size())));
      code.erase(code.find_last_not_of(" \t\r\n") + 1);
      description_.asp_blocks.push_back({chunk.section == "asp"         ? AspPart::kBase
                                         : chunk.section == "asp state" ? AspPart::kState
                                                                        : AspPart::kTransition,
                                         std::move(code),
                                         {file_, chunk.line + 1, 1}});
      continue;
    }
    const auto kind = kindOf(chunk.section);
    Node node =
        grammar::parse(kind.value_or(grammar::Kind::kObservation), chunk.text, start, problems);
    switch (node.rule)
    {
      case Rule::kNone:
        if (!kind)
        {
          problems.back().message +=
              "; no section has begun (sorts, statics, facts, fluents, actions, axioms, "
              "observations, defaults or asp)";
        }
        break;
      case Rule::kSortDeclaration:
      case Rule::kFluentDeclaration:
      case Rule::kActionDeclaration:
        declare(node, chunk.section);
        break;
      default:
        later_.push_back({file, std::move(node)});
    }
  }
}

Description Builder::finish()
{
  for (const Later& later : later_)
  {
    file_ = later.file;
    addStatement(later.node);
  }
  later_.clear();
  return std::move(description_);
}

}  // namespace kr3::reasoner
