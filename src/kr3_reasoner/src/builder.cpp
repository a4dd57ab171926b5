#include "builder.hpp"

#include <map>
#include <optional>
#include <utility>

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

std::string nameOf(const Node& node)
{
  return node.child(Rule::kName)->text;
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

bool isTerm(const Node& node)
{
  return node.rule == Rule::kName || node.rule == Rule::kVariable || node.rule == Rule::kNumber;
}

Comparison::Operator operatorOf(const std::string& text)
{
  static const std::map<std::string, Comparison::Operator> kOperators = {
      {"=", Comparison::Operator::kEqual},   {"!=", Comparison::Operator::kNotEqual},
      {"<", Comparison::Operator::kLess},    {"<=", Comparison::Operator::kLessEqual},
      {">", Comparison::Operator::kGreater}, {">=", Comparison::Operator::kGreaterEqual},
  };
  return kOperators.at(text);
}

Sort sortOf(const Node& node, std::vector<Diagnostic>& problems)
{
  constexpr int kMaxRange = 100000;
  Sort sort;
  sort.name = nameOf(node);
  sort.position = node.position;
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
        sort.elements.push_back(element.text);
      }
    }
    else if (part.rule == Rule::kRange)
    {
      const long first = std::stol(part.children[0].text.substr(0, 12));
      const long last = std::stol(part.children[1].text.substr(0, 12));
      if (last < first || last - first > kMaxRange)
      {
        problems.push_back({part.position, "found the range " + part.text +
                                               ", expected a first number that is not "
                                               "above the last, and at most 100000 numbers"});
        continue;
      }
      for (long number = first; number <= last; ++number)
      {
        sort.elements.push_back(std::to_string(number));
      }
    }
  }
  return sort;
}

}  // namespace

Term Builder::term(const Node& node)
{
  return {node.rule == Rule::kVariable, node.text};
}

Atom Builder::atom(const Node& node)
{
  Atom atom;
  atom.name = nameOf(node);
  atom.position = node.position;
  if (const Node* arguments = node.child(Rule::kArguments))
  {
    for (const Node& argument : arguments->children)
    {
      atom.arguments.push_back(term(argument));
    }
  }
  return atom;
}

bool Builder::isSort(const std::string& name) const
{
  return description_.findSort(name) != nullptr ||
         (base_ != nullptr && base_->findSort(name) != nullptr);
}

bool Builder::isFluent(const std::string& name) const
{
  return description_.findFluent(name) != nullptr ||
         (base_ != nullptr && base_->findFluent(name) != nullptr);
}

Condition Builder::condition(const Node& node)
{
  const std::vector<Node>& parts = node.children;
  if (isTerm(parts[0]))
  {
    return Comparison{term(parts[0]), operatorOf(parts[1].text), term(parts[2])};
  }
  if (parts[0].rule == Rule::kMinus || parts[0].rule == Rule::kNot)
  {
    Literal literal{atom(parts[1]), {false, "false"}, true};
    if (isSort(literal.atom.name) && !isFluent(literal.atom.name) &&
        literal.atom.arguments.size() == 1)
    {
      return Membership{literal.atom.name, literal.atom.arguments[0], true};
    }
    if (parts[0].rule == Rule::kNot && isFluent(literal.atom.name))
    {
      problems.push_back(
          {node.position, "found 'not' before the fluent " + literal.atom.name +
                              ", expected '-': the language has no default negation"});
    }
    return literal;
  }
  Literal literal{atom(parts[0]), {false, "true"}, true};
  const Atom& head = literal.atom;
  if (parts.size() == 1)
  {
    if (isSort(head.name) && !isFluent(head.name) && head.arguments.size() == 1)
    {
      return Membership{head.name, head.arguments[0], false};
    }
    return literal;
  }
  if (head.arguments.empty() && !isFluent(head.name))
  {
    return Comparison{{false, head.name}, operatorOf(parts[1].text), term(parts[2])};
  }
  if (parts[1].text != "=" && parts[1].text != "!=")
  {
    problems.push_back(
        {parts[1].position, "found '" + parts[1].text + "' after a fluent, expected '=' or '!='"});
  }
  literal.equal = parts[1].text != "!=";
  literal.value = term(parts[2]);
  return literal;
}

Literal Builder::literal(const Node& node)
{
  Condition parsed = condition(node);
  if (auto* literal = std::get_if<Literal>(&parsed))
  {
    return std::move(*literal);
  }
  problems.push_back(
      {node.position, "found a condition that names no fluent, expected a literal of a fluent"});
  return {};
}

Body Builder::body(const Node& node)
{
  Body body;
  if (const Node* conditions = node.rule == Rule::kBody ? &node : node.child(Rule::kBody))
  {
    for (const Node& part : conditions->children)
    {
      body.push_back(condition(part));
    }
  }
  return body;
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

void Builder::addAxiom(const Node& node)
{
  if (node.rule == Rule::kImpossible)
  {
    Executability rule;
    rule.position = node.position;
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
  else if (node.rule == Rule::kCausalLaw)
  {
    CausalLaw law{atom(node.children.front()), {}, body(node), node.position};
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
  else
  {
    StateConstraint constraint{std::nullopt, body(node), node.position};
    if (const Node* head = node.child(Rule::kCondition))
    {
      constraint.head = literal(*head);
    }
    description_.constraints.push_back(std::move(constraint));
  }
}

void Builder::addOther(const Node& node)
{
  switch (node.rule)
  {
    case Rule::kObservationLaw:
    {
      ObservationLaw law{atom(node.children[0]), atom(node.children[1]), std::nullopt,
                         node.position};
      if (node.children.size() > 2)
      {
        law.value = term(node.children[2]);
      }
      description_.observations.push_back(std::move(law));
      break;
    }
    case Rule::kDefault:
      description_.defaults.push_back({atom(node.children[0]),
                                       literal(*node.child(Rule::kCondition)), body(node),
                                       node.position});
      break;
    case Rule::kFact:
      description_.static_facts.push_back(literal(node));
      break;
    case Rule::kMagnification:
      description_.magnifications.push_back({nameOf(node.children[0]), nameOf(node.children[1]),
                                             node.children[2].text, node.position});
      break;
    case Rule::kPreference:
      description_.preferences.push_back(
          {atom(node.children[0]), atom(node.children[1]), node.position});
      break;
    case Rule::kCost:
      description_.costs.push_back({atom(node.children[0]),
                                    std::stod(node.child(Rule::kDecimal)->text), body(node),
                                    node.position});
      break;
    default:
      addAxiom(node);
  }
}

void Builder::declare(const Node& node, const std::string& section)
{
  if (node.rule == Rule::kSortDeclaration)
  {
    description_.sorts.push_back(sortOf(node, problems));
  }
  else if (node.rule == Rule::kActionDeclaration)
  {
    description_.actions.push_back(
        {nameOf(node), parametersOf(node), node.child(Rule::kExogenous) != nullptr, node.position});
  }
  else
  {
    FluentDeclaration fluent{nameOf(node), FluentKind::kStatic, parametersOf(node), std::nullopt,
                             node.position};
    if (section == "fluents")
    {
      const std::string& kind = node.child(Rule::kFluentKind)->text;
      fluent.kind = kind == "inertial"  ? FluentKind::kInertial
                    : kind == "defined" ? FluentKind::kDefined
                                        : FluentKind::kKnowledge;
    }
    if (const Node* value = node.child(Rule::kValueSort))
    {
      const std::string sort = nameOf(value->children[0]);
      fluent.value_sort = sort == "boolean" ? std::nullopt : std::optional(sort);
    }
    description_.fluents.push_back(std::move(fluent));
  }
}

Description Builder::build(const std::string& text)
{
  std::vector<Node> later;  // what needs the names of all declarations
  for (const grammar::Chunk& chunk : grammar::split(text, file_))
  {
    const auto kind = kindOf(chunk.section);
    Node node = grammar::parse(kind.value_or(grammar::Kind::kObservation), chunk.text,
                               chunk.position, problems);
    switch (node.rule)
    {
      case Rule::kNone:
        if (!kind)
        {
          problems.back().message +=
              "; no section has begun (sorts, statics, fluents, actions, axioms, observations, "
              "defaults or facts)";
        }
        break;
      case Rule::kSortDeclaration:
      case Rule::kFluentDeclaration:
      case Rule::kActionDeclaration:
        declare(node, chunk.section);
        break;
      default:
        later.push_back(std::move(node));
    }
  }
  for (const Node& node : later)
  {
    addOther(node);
  }
  return std::move(description_);
}

Formula Builder::formula(const Node& node)
{
  if (node.rule == Rule::kCondition)
  {
    Formula leaf;
    leaf.literal = literal(node);
    return leaf;
  }
  if (node.rule != Rule::kNegation && node.children.size() == 1)
  {
    return formula(node.children[0]);
  }
  Formula formula_here;
  formula_here.kind = node.rule == Rule::kNegation      ? Formula::Kind::kNot
                      : node.rule == Rule::kDisjunction ? Formula::Kind::kOr
                                                        : Formula::Kind::kAnd;
  for (const Node& child : node.children)
  {
    if (child.rule != Rule::kNot)
    {
      formula_here.operands.push_back(formula(child));
    }
  }
  return formula_here;
}

}  // namespace kr3::reasoner
