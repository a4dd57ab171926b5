#pragma once

#include <vector>

#include "conditions.hpp"

namespace kr3::reasoner
{

/// Numbers of the ground fluents' values and of the ground actions of a description, computed from
/// their arguments: in the order of declaration, then of the elements of the sorts, the last
/// argument varying fastest; of a fluent its values follow one another. Private to the package.
class Signature
{
public:
  /// @param vocabulary  must outlive this
  /// @param exogenous   whether exogenous actions have numbers
  Signature(const Vocabulary& vocabulary, bool exogenous);

  [[nodiscard]] std::size_t numValues() const { return num_values_; }
  [[nodiscard]] std::size_t numActions() const { return num_actions_; }

  /// Whether an action has numbers.
  [[nodiscard]] bool hasAction(int symbol) const { return actions_[symbol].present; }
  [[nodiscard]] std::size_t firstAction(int symbol) const { return actions_[symbol].first; }
  [[nodiscard]] std::size_t numInstances(int symbol) const { return actions_[symbol].size; }

  /// Number of `fluent = value`, or -1 when there is no such fluent or value.
  [[nodiscard]] int value(int fluent, const std::vector<Slot>& arguments, const Slot& value,
                          const RuleBinding& binding) const;
  [[nodiscard]] int action(int action, const std::vector<Slot>& arguments,
                           const RuleBinding& binding) const;

  /// Number of a fluent's values: 0 when its value sort is empty.
  [[nodiscard]] std::size_t valuesOf(int fluent) const { return fluents_[fluent].num_values; }

private:
  static constexpr int kBoolean = -1;

  /// Where the instances of a fluent or an action begin, and how arguments count.
  struct Instances
  {
    std::size_t first = 0;
    std::size_t size = 0;
    bool present = true;
    std::vector<int> sorts;
    std::vector<std::size_t> strides;
    int value_sort = kBoolean;
    std::size_t num_values = 0;
  };

  void count(Instances& instances, const std::vector<std::string>& sorts,
             std::size_t innermost) const;
  [[nodiscard]] int number(const Instances& instances, const std::vector<Slot>& arguments,
                           const RuleBinding& binding) const;

  const Vocabulary& vocabulary_;
  std::vector<Instances> fluents_;
  std::vector<Instances> actions_;
  std::size_t num_values_ = 0;
  std::size_t num_actions_ = 0;
};

}  // namespace kr3::reasoner
