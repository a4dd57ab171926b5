#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "rule_sink.hpp"
#include "search_limit.hpp"

namespace kr3::reasoner
{

/// A ground program of its own, of few atoms, with fluents and priced assumptions. Private to the
/// package.
struct LocalProgram
{
  struct Assumption
  {
    SolverLiteral literal;
    int price;
    bool is_retraction;
  };
  struct Rule
  {
    bool choice;
    bool conjunction;  ///< otherwise the weights of the body's true literals reach the bound
    std::int32_t bound;
    std::vector<Clingo::atom_t> heads;
    std::vector<Clingo::WeightedLiteral> body;
  };

  Clingo::atom_t num_atoms = 0;                     ///< atoms are numbered from 1
  std::vector<std::vector<SolverLiteral>> fluents;  ///< a literal for each value, or kFalseLiteral
  std::vector<Assumption> assumptions;
  std::vector<Rule> rules;

  /// Equal texts: equal programs.
  [[nodiscard]] std::string key() const;
};

/// The combinations of values of a program's fluents, with the cheapest assumptions for each.
struct LocalTable
{
  struct Row
  {
    std::vector<std::size_t> values;                     ///< by fluent
    std::vector<std::vector<std::size_t>> explanations;  ///< indices of assumptions, sorted
  };
  std::vector<Row> rows;  ///< by their values; none: the program is inconsistent
  bool complete = true;   ///< false: there are more combinations than was allowed
};

/// How much of what may have come about is kept.
struct TableLimits
{
  std::size_t max_combinations = 1000;  ///< of values that hang together
  std::size_t max_explanations = 16;    ///< equally good ones of a combination; more are dropped
};

/// Makes tables, once for all programs that are equal but for names and order. A program's table is
/// the same whichever came first.
class LocalTables
{
public:
  explicit LocalTables(const TableLimits& limits) : limits_(limits) {}

  /// @throws Cancelled, DeadlineExceeded  the limit was reached
  [[nodiscard]] LocalTable of(const LocalProgram& program, const SearchLimit& limit);

private:
  TableLimits limits_;
  std::unordered_map<std::string, LocalTable> known_;
};

}  // namespace kr3::reasoner
