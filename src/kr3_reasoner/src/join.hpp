#pragma once

#include <functional>
#include <vector>

#include "statics.hpp"

namespace kr3::reasoner
{

/// Finds the bindings of a rule's variables under which its Conditions hold: variables are bound in
/// an order in which each step has few candidates, from the rows of a static that other variables
/// restrict, or from the smallest of their sorts. Private to the package; not thread-safe.
class Join
{
public:
  /// @param conditions  must outlive this
  /// @param statics     must outlive this; rows may be added between two runs
  /// @param given       by variable: bound at the start of a run
  /// @param wanted      by variable: whose values matter; for the others it is enough that there
  ///                    are some, and their values in a binding mean nothing
  Join(const Conditions& conditions, const Statics& statics, const std::vector<bool>& given,
       const std::vector<bool>& wanted, const SearchLimit& limit = {});

  /// Calls `visit` with each binding that extends `start`, once for the values of what is wanted.
  /// @throws Cancelled, DeadlineExceeded  the limit was reached
  void forEach(const RuleBinding& start, const std::function<void(const RuleBinding&)>& visit);

private:
  /// How one or more variables get their values, and what can be decided then.
  struct Level
  {
    int source = -1;         ///< index in Conditions::statics, or -1: the elements of a sort
    std::size_t column = 0;  ///< of the static that is bound already, or kNoColumn
    int variable = -1;       ///< of a sort
    int sort = -1;
    std::vector<int> binds;  ///< variables
    std::vector<std::size_t> statics;
    std::vector<std::size_t> relations;
    std::vector<std::size_t> sort_tests;
  };
  static constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

  [[nodiscard]] Level cheapest(const std::vector<bool>& bound,
                               const std::vector<bool>& wanted) const;
  void addChecks(Level& level, const std::vector<bool>& bound, std::vector<bool>& checked_statics,
                 std::vector<bool>& checked_relations, std::vector<bool>& checked_sorts) const;
  [[nodiscard]] bool passes(const Level& level) const;
  [[nodiscard]] bool fitsSorts(int variable) const;
  bool run(std::size_t level);
  [[nodiscard]] bool bindRow(const LiteralPattern& literal, const std::vector<ConstantId>& row,
                             const Level& level);
  void found();

  const Conditions& conditions_;
  const Statics& statics_;
  SearchLimit limit_;
  std::uint32_t num_looks_ = 0;
  std::vector<bool> given_;
  std::vector<std::size_t> wanted_;  // variables
  Level start_;                      // what can be decided before the first variable is bound
  std::vector<Level> levels_;
  std::size_t last_wanted_ = 0;  // levels from here on bind nothing that is wanted
  bool may_repeat_ = false;

  // One run.
  RuleBinding binding_;
  const std::function<void(const RuleBinding&)>* visit_ = nullptr;
  std::unordered_set<std::vector<ConstantId>, ConstantsHash> seen_;
};

}  // namespace kr3::reasoner
