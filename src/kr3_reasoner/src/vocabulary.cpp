#include "vocabulary.hpp"

#include <cstdlib>

namespace kr3::reasoner
{

namespace
{

bool isNumber(const std::string& text)
{
  const std::size_t start = text.empty() || text[0] != '-' ? 0 : 1;
  return text.size() > start && text.find_first_not_of("0123456789", start) == std::string::npos;
}

}  // namespace

Vocabulary::Vocabulary(const Description& description) : description_(description)
{
  for (const char* truth : {"false", "true"})
  {
    add(truth);
  }
  for (const Sort& sort : description.sorts)
  {
    sorts_.emplace(sort.name, static_cast<int>(elements_.size()));
    elements_.emplace_back();
    elements_.back().reserve(sort.elements.size());
    for (const std::string& element : sort.elements)
    {
      elements_.back().push_back(add(element));
    }
  }
  for (const auto& elements : elements_)
  {
    std::vector<int>& positions = positions_.emplace_back(names_.size(), -1);
    for (std::size_t i = 0; i < elements.size(); ++i)
    {
      positions[elements[i]] = static_cast<int>(i);
    }
  }
  for (const FluentDeclaration& fluent : description.fluents)
  {
    fluents_.emplace(fluent.name, static_cast<int>(fluents_.size()));
  }
  for (const ActionDeclaration& action : description.actions)
  {
    actions_.emplace(action.name, static_cast<int>(actions_.size()));
  }
}

ConstantId Vocabulary::constant(const std::string& name) const
{
  const auto found = constants_.find(name);
  return found == constants_.end() ? kUnbound : found->second;
}

ConstantId Vocabulary::add(const std::string& name)
{
  const auto [place, fresh] = constants_.emplace(name, static_cast<ConstantId>(names_.size()));
  if (fresh)
  {
    names_.push_back(name);
    numbers_.push_back(isNumber(name) ? std::strtol(name.c_str(), nullptr, 10) : kNoNumber);
  }
  return place->second;
}

bool satisfies(int order, Comparison::Operator op)
{
  switch (op)
  {
    case Comparison::Operator::kEqual:
      return order == 0;
    case Comparison::Operator::kNotEqual:
      return order != 0;
    case Comparison::Operator::kLess:
      return order < 0;
    case Comparison::Operator::kLessEqual:
      return order <= 0;
    case Comparison::Operator::kGreater:
      return order > 0;
    case Comparison::Operator::kGreaterEqual:
      return order >= 0;
  }
  return false;
}

bool Vocabulary::holds(ConstantId left, Comparison::Operator op, ConstantId right) const
{
  int order = 0;
  if (left != right)
  {
    const long a = numbers_[left];
    const long b = numbers_[right];
    order = a != kNoNumber && b != kNoNumber ? (a < b   ? -1
                                                : a > b ? 1
                                                        : 0)
                                             : names_[left].compare(names_[right]);
  }
  return satisfies(order, op);
}

}  // namespace kr3::reasoner
