#include "builder.hpp"

#include <cstdlib>
#include <map>
#include <utility>

#include "predicate_form.hpp"

namespace kr3::reasoner
{

using grammar::Node;
using grammar::Rule;

namespace
{

Comparison::Operator operatorOf(std::string_view text)
{
  static const std::map<std::string_view, Comparison::Operator> kOperators = {
      {"=", Comparison::Operator::kEqual},   {"!=", Comparison::Operator::kNotEqual},
      {"<", Comparison::Operator::kLess},    {"<=", Comparison::Operator::kLessEqual},
      {">", Comparison::Operator::kGreater}, {">=", Comparison::Operator::kGreaterEqual},
  };
  return kOperators.at(text);
}

}  // namespace

std::string nameOf(const Node& node)
{
  return std::string(node.child(Rule::kName)->text);
}

bool isTerm(const Node& node)
{
  return node.rule == Rule::kName || node.rule == Rule::kVariable || node.rule == Rule::kNumber;
}

Builder::Builder(std::string file, const Description* base) : file_(std::move(file)), base_(base)
{
  if (base_ != nullptr)
  {
    for (const Sort& sort : base_->sorts)
    {
      sorts_.insert(sort.name);
    }
    for (const FluentDeclaration& fluent : base_->fluents)
    {
      fluents_.insert(fluent.name);
    }
  }
}

SourcePosition Builder::position(const Node& node) const
{
  return {file_, node.line, node.column};
}

void Builder::report(const Node& node, const std::string& message)
{
  problems.push_back({position(node), message});
}

std::string Builder::number(const Node& node)
{
  // The numbers of answer set programs have 32 bits.
  constexpr long kLargest = 2147483647;
  const bool negative = node.text[0] == '-';
  const std::string_view digits = node.text.substr(negative ? 1 : 0);
  const std::size_t zeros = digits.find_first_not_of('0');
  const std::string_view significant = zeros == std::string_view::npos ? "" : digits.substr(zeros);
  const long value = significant.size() > 10
                         ? kLargest + 1
                         : std::strtol(std::string(significant).c_str(), nullptr, 10);
  if (value > kLargest)
  {
    report(node, "found a number of " + std::to_string(significant.size()) +
                     " digits, expected one from -2147483647 to 2147483647");
    return "0";
  }
  return std::to_string(negative ? -value : value);
}

double Builder::decimal(const Node& node)
{
  constexpr std::size_t kMaxDigits = 30;
  if (node.text.size() > kMaxDigits)
  {
    report(node, "found a number of " + std::to_string(node.text.size()) +
                     " characters, expected at most " + std::to_string(kMaxDigits));
    return 0.0;
  }
  return std::strtod(std::string(node.text).c_str(), nullptr);
}

Term Builder::term(const Node& node)
{
  return {node.rule == Rule::kVariable,
          node.rule == Rule::kNumber ? number(node) : std::string(node.text)};
}

Atom Builder::atom(const Node& node)
{
  Atom atom;
  atom.name = nameOf(node);
  atom.position = position(node);
  if (const Node* arguments = node.child(Rule::kArguments))
  {
    for (const Node& argument : arguments->children)
    {
      atom.arguments.push_back(term(argument));
    }
  }
  return atom;
}

Condition Builder::withoutSign(const Node& node)
{
  const std::vector<Node>& parts = node.children;
  if (isTerm(parts[0]))
  {
    return Comparison{term(parts[0]), operatorOf(parts[1].text), term(parts[2]), position(node)};
  }
  Literal literal{atom(parts[0]), {false, "true"}, true};
  const Atom& head = literal.atom;
  if (parts.size() == 1)
  {
    if (isSort(head.name) && !isFluent(head.name) && head.arguments.size() == 1)
    {
      return Membership{head.name, head.arguments[0], false, position(node)};
    }
    return literal;
  }
  if (head.arguments.empty() && !isFluent(head.name))
  {
    return Comparison{
        {false, head.name}, operatorOf(parts[1].text), term(parts[2]), position(node)};
  }
  if (parts[1].text != "=" && parts[1].text != "!=")
  {
    report(parts[1],
           "found '" + std::string(parts[1].text) + "' after a fluent, expected '=' or '!='");
  }
  literal.equal = parts[1].text != "!=";
  literal.value = term(parts[2]);
  return literal;
}

Condition Builder::condition(const Node& node)
{
  const std::vector<Node>& parts = node.children;
  if (parts[0].rule != Rule::kMinus && parts[0].rule != Rule::kNot)
  {
    Condition condition = withoutSign(node);
    if (auto* literal = std::get_if<Literal>(&condition); literal != nullptr && base_ != nullptr)
    {
      makeFunctional(*literal, *base_);
    }
    return condition;
  }
  Literal literal{atom(parts[1]), {false, "false"}, true};
  if (isSort(literal.atom.name) && !isFluent(literal.atom.name) &&
      literal.atom.arguments.size() == 1)
  {
    return Membership{literal.atom.name, literal.atom.arguments[0], true, position(node)};
  }
  if (parts[0].rule == Rule::kNot && isFluent(literal.atom.name))
  {
    report(node, "found 'not' before the fluent " + literal.atom.name +
                     ", expected '-': the language has no default negation");
  }
  if (base_ != nullptr)
  {
    makeFunctional(literal, *base_);
  }
  return literal;
}

Literal Builder::literal(const Node& node)
{
  Condition parsed = condition(node);
  if (auto* literal = std::get_if<Literal>(&parsed))
  {
    return std::move(*literal);
  }
  report(node, "found a condition that names no fluent, expected a literal of a fluent");
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
    if (child.rule != Rule::kNot && child.rule != Rule::kMinus)
    {
      formula_here.operands.push_back(formula(child));
    }
  }
  return formula_here;
}

}  // namespace kr3::reasoner
