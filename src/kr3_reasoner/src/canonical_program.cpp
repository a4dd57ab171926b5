#include "canonical_program.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <tuple>

namespace kr3::reasoner
{

namespace
{

using Colour = std::uint64_t;

/// Steele, Lea, Flood, *Fast splittable pseudorandom number generators* (2014), section 3.
Colour mixed(Colour z)
{
  z += 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

Colour mixed(Colour first, std::int64_t second)
{
  return mixed(first ^ mixed(static_cast<Colour>(second)));
}

std::size_t indexOf(SolverLiteral literal)
{
  return static_cast<std::size_t>(std::abs(literal)) - 1;
}

/// Colours of a program's atoms.
class Colouring
{
public:
  Colouring(const LocalProgram& program, const SearchLimit& limit)
    : program_(program), limit_(limit), colours_(program.num_atoms)
  {
    for (std::size_t f = 0; f < program.fluents.size(); ++f)
    {
      for (const SolverLiteral literal : program.fluents[f])
      {
        if (!isConstant(literal))
        {
          see(colours_, literal, mixed(1, static_cast<std::int64_t>(f)));
        }
      }
    }
    for (const LocalProgram::Assumption& assumption : program.assumptions)
    {
      see(colours_, assumption.literal, mixed(assumption.is_retraction ? 2 : 3, assumption.price));
    }
    refine();
  }

  /// The number of each atom, from 1, when every one has a colour of its own.
  std::vector<Clingo::atom_t> numbers()
  {
    std::vector<std::size_t> order(colours_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto byColour = [&](std::size_t a, std::size_t b) {
      return std::tie(colours_[a], a) < std::tie(colours_[b], b);
    };
    for (;;)
    {
      std::sort(order.begin(), order.end(), byColour);
      const auto alike = [&](std::size_t a, std::size_t b) { return colours_[a] == colours_[b]; };
      const auto first = std::adjacent_find(order.begin(), order.end(), alike);
      if (first == order.end())
      {
        break;
      }
      const Colour colour = colours_[*first];
      std::int64_t place = 0;
      for (auto atom = first; atom != order.end() && colours_[*atom] == colour; ++atom)
      {
        colours_[*atom] = mixed(colour, ++place);
      }
      refine();
    }
    std::vector<Clingo::atom_t> numbers(order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
    {
      numbers[order[i]] = static_cast<Clingo::atom_t>(i + 1);
    }
    return numbers;
  }

private:
  static void see(std::vector<Colour>& colours, SolverLiteral literal, Colour what)
  {
    colours[indexOf(literal)] += mixed(what, literal < 0 ? 1 : 0);
  }

  /// Until no further atoms are told apart.
  void refine()
  {
    std::size_t before = 0;
    for (std::size_t now = count(); now > before && now < colours_.size(); now = count())
    {
      limit_.check();
      before = now;
      lookAround();
    }
  }

  /// How many colours there are.
  [[nodiscard]] std::size_t count()
  {
    sorted_ = colours_;
    std::sort(sorted_.begin(), sorted_.end());
    return static_cast<std::size_t>(std::unique(sorted_.begin(), sorted_.end()) - sorted_.begin());
  }

  /// Each atom's colour becomes one of its own and those of the atoms that it has rules with.
  void lookAround()
  {
    std::vector<Colour> seen = colours_;
    for (const LocalProgram::Rule& rule : program_.rules)
    {
      Colour of_rule = mixed((rule.choice ? 2U : 0U) + (rule.conjunction ? 1U : 0U), rule.bound);
      for (const Clingo::atom_t head : rule.heads)
      {
        of_rule += mixed(colours_[head - 1], 0);
      }
      for (const Clingo::WeightedLiteral& literal : rule.body)
      {
        const Colour colour = colours_[indexOf(literal.literal())];
        of_rule += mixed(mixed(colour, literal.weight()), literal.literal() < 0 ? 1 : 2);
      }
      of_rule = mixed(of_rule);
      for (const Clingo::atom_t head : rule.heads)
      {
        seen[head - 1] += mixed(of_rule, 0);
      }
      for (const Clingo::WeightedLiteral& literal : rule.body)
      {
        see(seen, literal.literal(), mixed(of_rule, literal.weight()));
      }
    }
    for (Colour& colour : seen)
    {
      colour = mixed(colour);
    }
    colours_ = std::move(seen);
  }

  const LocalProgram& program_;
  const SearchLimit& limit_;
  std::vector<Colour> colours_;
  std::vector<Colour> sorted_;  // kept for its memory
};

SolverLiteral renumbered(SolverLiteral literal, const std::vector<Clingo::atom_t>& numbers)
{
  const auto number = static_cast<SolverLiteral>(numbers[indexOf(literal)]);
  return literal < 0 ? -number : number;
}

auto ranked(const Clingo::WeightedLiteral& literal)
{
  return std::make_tuple(literal.literal(), literal.weight());
}

bool comesBefore(const LocalProgram::Rule& a, const LocalProgram::Rule& b)
{
  const auto kindOf = [](const LocalProgram::Rule& rule) {
    return std::make_tuple(rule.choice, rule.conjunction, rule.bound, std::cref(rule.heads));
  };
  if (kindOf(a) != kindOf(b))
  {
    return kindOf(a) < kindOf(b);
  }
  return std::lexicographical_compare(
      a.body.begin(), a.body.end(), b.body.begin(), b.body.end(),
      [](const auto& first, const auto& second) { return ranked(first) < ranked(second); });
}

}  // namespace

CanonicalProgram::CanonicalProgram(const LocalProgram& original, const SearchLimit& limit)
{
  const std::vector<Clingo::atom_t> numbers = Colouring(original, limit).numbers();
  program_.num_atoms = original.num_atoms;
  takeFluents(original, numbers);
  takeAssumptions(original, numbers);
  takeRules(original, numbers);
}

void CanonicalProgram::takeFluents(const LocalProgram& original,
                                   const std::vector<Clingo::atom_t>& numbers)
{
  for (const auto& literals : original.fluents)
  {
    std::vector<std::pair<SolverLiteral, std::size_t>> taken;
    for (std::size_t value = 0; value < literals.size(); ++value)
    {
      if (!isConstant(literals[value]))
      {
        taken.emplace_back(renumbered(literals[value], numbers), value);
      }
    }
    std::sort(taken.begin(), taken.end());
    program_.fluents.emplace_back();
    values_.emplace_back();
    for (const auto& [literal, value] : taken)
    {
      program_.fluents.back().push_back(literal);
      values_.back().push_back(value);
    }
  }
}

void CanonicalProgram::takeAssumptions(const LocalProgram& original,
                                       const std::vector<Clingo::atom_t>& numbers)
{
  for (const LocalProgram::Assumption& assumption : original.assumptions)
  {
    program_.assumptions.push_back(assumption);
    program_.assumptions.back().literal = renumbered(assumption.literal, numbers);
  }
  assumptions_.resize(original.assumptions.size());
  std::iota(assumptions_.begin(), assumptions_.end(), 0);
  std::sort(assumptions_.begin(), assumptions_.end(), [&](std::size_t a, std::size_t b) {
    const LocalProgram::Assumption& first = program_.assumptions[a];
    const LocalProgram::Assumption& second = program_.assumptions[b];
    return std::tie(first.literal, first.price, first.is_retraction, a) <
           std::tie(second.literal, second.price, second.is_retraction, b);
  });
  std::vector<LocalProgram::Assumption> sorted;
  for (const std::size_t index : assumptions_)
  {
    sorted.push_back(program_.assumptions[index]);
  }
  program_.assumptions = std::move(sorted);
}

void CanonicalProgram::takeRules(const LocalProgram& original,
                                 const std::vector<Clingo::atom_t>& numbers)
{
  for (const LocalProgram::Rule& rule : original.rules)
  {
    LocalProgram::Rule taken{rule.choice, rule.conjunction, rule.bound, {}, {}};
    for (const Clingo::atom_t head : rule.heads)
    {
      taken.heads.push_back(numbers[head - 1]);
    }
    for (const Clingo::WeightedLiteral& literal : rule.body)
    {
      taken.body.emplace_back(renumbered(literal.literal(), numbers), literal.weight());
    }
    std::sort(taken.heads.begin(), taken.heads.end());
    std::sort(taken.body.begin(), taken.body.end(),
              [](const auto& a, const auto& b) { return ranked(a) < ranked(b); });
    program_.rules.push_back(std::move(taken));
  }
  std::sort(program_.rules.begin(), program_.rules.end(), comesBefore);
}

LocalTable CanonicalProgram::original(const LocalTable& table) const
{
  LocalTable result = table;
  for (LocalTable::Row& row : result.rows)
  {
    for (std::size_t f = 0; f < row.values.size(); ++f)
    {
      row.values[f] = values_[f].at(row.values[f]);
    }
    for (auto& explanation : row.explanations)
    {
      for (std::size_t& assumption : explanation)
      {
        assumption = assumptions_[assumption];
      }
      std::sort(explanation.begin(), explanation.end());
    }
    std::sort(row.explanations.begin(), row.explanations.end());
  }
  std::sort(result.rows.begin(), result.rows.end(),
            [](const auto& a, const auto& b) { return a.values < b.values; });
  return result;
}

}  // namespace kr3::reasoner
