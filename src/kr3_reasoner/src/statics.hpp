#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "conditions.hpp"
#include "search_limit.hpp"

namespace kr3::reasoner
{

struct ConstantsHash
{
  std::size_t operator()(const std::vector<ConstantId>& constants) const
  {
    std::size_t hash = constants.size();
    for (const ConstantId constant : constants)
    {
      hash = (hash ^ static_cast<std::size_t>(constant + 1)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 32U;
    }
    return hash;
  }
};

/// The statics of a description: its facts and what its axioms derive from them. A row is the
/// arguments and the value, which is `true` of a boolean static. Private to the package.
///
/// Axioms may use the absence of rows. The checks of the language see to it that no row rests on
/// its own absence, so that the well-founded model, which is what this computes, has every row
/// either in or out.
class Statics
{
public:
  /// @param vocabulary  must outlive this
  /// @throws Cancelled, DeadlineExceeded  the limit was reached
  explicit Statics(Vocabulary& vocabulary, const SearchLimit& limit = {});

  [[nodiscard]] const Vocabulary& vocabulary() const { return vocabulary_; }

  /// Whether a ground literal is true. A static may have no value: then `f != v` is true.
  [[nodiscard]] bool holds(int symbol, const std::vector<ConstantId>& arguments, ConstantId value,
                           bool equal) const;
  [[nodiscard]] bool holds(const LiteralPattern& literal, const RuleBinding& binding) const;

  [[nodiscard]] std::size_t numRows(int symbol) const { return relations_[symbol].rows.size(); }
  [[nodiscard]] const std::vector<ConstantId>& row(int symbol, std::uint32_t number) const
  {
    return relations_[symbol].rows[number];
  }
  /// The rows with a constant in a column.
  [[nodiscard]] const std::vector<std::uint32_t>& rowsWith(int symbol, std::size_t column,
                                                           ConstantId constant) const;
  /// How many rows there are for one constant in a column, on the average.
  [[nodiscard]] double rowsPerConstant(int symbol, std::size_t column) const;

private:
  struct Relation
  {
    std::vector<std::vector<ConstantId>> rows;
    std::unordered_set<std::vector<ConstantId>, ConstantsHash> known;
    std::vector<std::vector<std::vector<std::uint32_t>>> by_constant;  // [column][constant]
    std::vector<std::size_t> num_constants;                            // by column
  };

  struct Derivation;
  using Derivations = std::vector<const Derivation*>;

  bool insert(int symbol, std::vector<ConstantId> row);
  void derive();
  void deriveWithNegation(const Derivations& rules, const std::vector<int>& symbols);
  void deriveAll(const Derivations& rules, const std::vector<Relation>& assumed);

  Vocabulary& vocabulary_;
  SearchLimit limit_;
  std::vector<Relation> relations_;  // by fluent symbol
};

}  // namespace kr3::reasoner
