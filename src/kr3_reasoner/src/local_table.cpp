#include "local_table.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <unordered_set>
#include <utility>

#include "assumable.hpp"
#include "canonical_program.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

namespace
{

void put(std::string& text, std::int64_t number)
{
  text += std::to_string(number);
  text += ' ';
}

/// The cheapest assumptions that were seen with the same values: retractions count first.
struct Cheapest
{
  std::optional<Price> price = {};
  std::vector<std::vector<std::size_t>> explanations = {};

  void consider(std::vector<std::size_t> assumed,
                const std::vector<LocalProgram::Assumption>& assumptions)
  {
    Price paid;
    for (const std::size_t index : assumed)
    {
      const LocalProgram::Assumption& assumption = assumptions[index];
      paid.add(assumption.price, assumption.is_retraction);
    }
    const auto ranked = [](const Price& one) {
      return std::make_pair(one.retractions, one.assumptions);
    };
    if (price && ranked(paid) > ranked(*price))
    {
      return;
    }
    if (price && ranked(paid) < ranked(*price))
    {
      explanations.clear();
    }
    price = paid;
    explanations.push_back(std::move(assumed));
  }
};

/// Finds the rows of a program.
class Tabulation
{
public:
  Tabulation(const LocalProgram& program, const TableLimits& limits, const SearchLimit& limit)
    : program_(program)
    , limits_(limits)
    , solver_({"0", "--opt-strategy=usc", "--project=project", "--warn=none"}, limit)
  {
    solver_.control().with_backend([&](Clingo::Backend& backend) {
      for (Clingo::atom_t atom = 0; atom < program_.num_atoms; ++atom)
      {
        atoms_.push_back(backend.add_atom());
      }
      write(backend);
    });
  }

  LocalTable run()
  {
    if (program_.assumptions.empty())
    {
      findRows();
    }
    else if (!findPricedRowsAtOnce())
    {
      findPricedRows();
    }
    return std::move(table_);
  }

private:
  [[nodiscard]] SolverLiteral here(SolverLiteral literal) const
  {
    const auto atom =
        static_cast<SolverLiteral>(atoms_[static_cast<std::size_t>(std::abs(literal)) - 1]);
    return literal < 0 ? -atom : atom;
  }

  void write(Clingo::Backend& backend)
  {
    for (const LocalProgram::Rule& rule : program_.rules)
    {
      std::vector<Clingo::atom_t> heads;
      for (const Clingo::atom_t head : rule.heads)
      {
        heads.push_back(atoms_[head - 1]);
      }
      std::vector<Clingo::literal_t> conjunction;
      std::vector<Clingo::WeightedLiteral> sum;
      for (const Clingo::WeightedLiteral& literal : rule.body)
      {
        conjunction.push_back(here(literal.literal()));
        sum.emplace_back(here(literal.literal()), literal.weight());
      }
      if (rule.conjunction)
      {
        backend.rule(rule.choice, {heads.data(), heads.size()},
                     {conjunction.data(), conjunction.size()});
      }
      else
      {
        backend.weight_rule(rule.choice, {heads.data(), heads.size()}, rule.bound,
                            {sum.data(), sum.size()});
      }
    }
    std::unordered_set<Clingo::atom_t> projected;
    const auto project = [&](SolverLiteral literal) {
      if (!isConstant(literal))
      {
        projected.insert(static_cast<Clingo::atom_t>(std::abs(here(literal))));
      }
    };
    std::vector<Clingo::WeightedLiteral> paid[2];
    for (const LocalProgram::Assumption& assumption : program_.assumptions)
    {
      project(assumption.literal);
      paid[assumption.is_retraction ? 1 : 0].emplace_back(here(assumption.literal),
                                                          assumption.price);
    }
    for (const auto& values : program_.fluents)
    {
      std::for_each(values.begin(), values.end(), project);
    }
    const std::vector<Clingo::atom_t> atoms(projected.begin(), projected.end());
    backend.project({atoms.data(), atoms.size()});
    for (const int priority : {1, 2})
    {
      const auto& literals = paid[priority - 1];
      if (!literals.empty())
      {
        backend.minimize(priority, {literals.data(), literals.size()});
      }
    }
  }

  [[nodiscard]] std::vector<std::size_t> valuesIn(const Clingo::Model& model) const
  {
    std::vector<std::size_t> values;
    for (const auto& literals : program_.fluents)
    {
      const auto found = std::find_if(literals.begin(), literals.end(), [&](SolverLiteral literal) {
        return !isConstant(literal) && model.is_true(here(literal));
      });
      values.push_back(static_cast<std::size_t>(found - literals.begin()));
    }
    return values;
  }

  [[nodiscard]] std::vector<std::size_t> assumedIn(const Clingo::Model& model) const
  {
    std::vector<std::size_t> assumed;
    for (std::size_t i = 0; i < program_.assumptions.size(); ++i)
    {
      if (model.is_true(here(program_.assumptions[i].literal)))
      {
        assumed.push_back(i);
      }
    }
    return assumed;
  }

  [[nodiscard]] std::vector<SolverLiteral> literalsOf(const std::vector<std::size_t>& values) const
  {
    std::vector<SolverLiteral> literals;
    for (std::size_t f = 0; f < values.size(); ++f)
    {
      literals.push_back(here(program_.fluents[f][values[f]]));
    }
    return literals;
  }

  /// Without assumptions, all rows are as good.
  void findRows()
  {
    solver_.configure("solve.models", std::to_string(limits_.max_combinations + 1));
    solver_.solve([&](const Clingo::Model& model) {
      table_.complete = table_.rows.size() < limits_.max_combinations;
      if (table_.complete)
      {
        table_.rows.push_back({valuesIn(model), {{}}});
      }
      return table_.complete;
    });
  }

  /// Looks at all combinations of values and assumptions, when they are few: one search is cheaper
  /// than one for each row.
  /// @return false: there are too many, and nothing was found out
  bool findPricedRowsAtOnce()
  {
    constexpr std::size_t kMost = 512;
    solver_.configure("solve.opt_mode", "ignore");
    solver_.configure("solve.models", std::to_string(kMost + 1));
    std::map<std::vector<std::size_t>, Cheapest> found;
    std::size_t seen = 0;
    solver_.solve([&](const Clingo::Model& model) {
      found[valuesIn(model)].consider(assumedIn(model), program_.assumptions);
      return ++seen <= kMost;
    });
    if (seen > kMost || found.size() > limits_.max_combinations)
    {
      return false;
    }
    for (auto& [values, cheapest] : found)
    {
      auto& explanations = cheapest.explanations;
      std::sort(explanations.begin(), explanations.end());
      explanations.resize(std::min(explanations.size(), limits_.max_explanations));
      table_.rows.push_back({values, std::move(explanations)});
    }
    return true;
  }

  void findPricedRows()
  {
    for (;;)
    {
      solver_.configure("solve.opt_mode", "opt");
      solver_.configure("solve.models", "0");
      LocalTable::Row row;
      const bool found = solver_.solve([&](const Clingo::Model& model) {
        row = {valuesIn(model), {assumedIn(model)}};
        return true;
      });
      if (!found)
      {
        break;
      }
      if (table_.rows.size() == limits_.max_combinations)
      {
        table_.complete = false;
        break;
      }
      const std::vector<SolverLiteral> literals = literalsOf(row.values);
      if (!row.explanations.front().empty())
      {
        row.explanations = explanations(literals);
      }
      table_.rows.push_back(std::move(row));
      RuleSink sink(solver_.control());
      sink.constraint(literals);
    }
  }

  [[nodiscard]] std::vector<std::vector<std::size_t>> explanations(
      const std::vector<SolverLiteral>& row)
  {
    solver_.configure("solve.opt_mode", "optN");
    solver_.configure("solve.models", std::to_string(limits_.max_explanations));
    std::vector<std::vector<std::size_t>> found;
    solver_.solve(
        [&](const Clingo::Model& model) {
      if (model.optimality_proven())
      {
        found.push_back(assumedIn(model));
      }
      return true;
        },
        row);
    return found;
  }

  const LocalProgram& program_;
  const TableLimits& limits_;
  Solver solver_;
  std::vector<Clingo::atom_t> atoms_;
  LocalTable table_;
};

}  // namespace

std::string LocalProgram::key() const
{
  std::string text;
  for (const auto& values : fluents)
  {
    put(text, static_cast<std::int64_t>(values.size()));
    for (const SolverLiteral literal : values)
    {
      put(text, isConstant(literal) ? 0 : literal);
    }
  }
  text += '|';
  for (const Assumption& assumption : assumptions)
  {
    put(text, assumption.literal);
    put(text, assumption.is_retraction ? -assumption.price : assumption.price);
  }
  for (const Rule& rule : rules)
  {
    text += rule.choice ? "c" : "r";
    text += rule.conjunction ? "c" : "w";
    put(text, rule.bound);
    put(text, static_cast<std::int64_t>(rule.heads.size()));
    for (const Clingo::atom_t head : rule.heads)
    {
      put(text, head);
    }
    for (const Clingo::WeightedLiteral& literal : rule.body)
    {
      put(text, literal.literal());
      put(text, literal.weight());
    }
  }
  return text;
}

LocalTable LocalTables::of(const LocalProgram& program, const SearchLimit& limit)
{
  constexpr std::size_t kMaxKnown = 5000;
  if (known_.size() > kMaxKnown)
  {
    known_.clear();
  }
  const CanonicalProgram canonical(program, limit);
  const std::string key = canonical.program().key();
  auto known = known_.find(key);
  if (known == known_.end())
  {
    known = known_.emplace(key, Tabulation(canonical.program(), limits_, limit).run()).first;
  }
  return canonical.original(known->second);
}

}  // namespace kr3::reasoner
