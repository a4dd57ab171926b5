#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// One outcome of an action in a class of states: an observation, and the class it leads to.
struct Branch
{
  std::uint32_t target_class;
  /// Row s: the states s' (local index in the target class) with T(s' | s, a) O(o | a, s').
  SparseRows joint;
};

/// What an action earns in a class, and its outcomes.
struct ClassAction
{
  std::vector<double> rewards;  ///< shape [states of the class]
  std::vector<Branch> branches;
};

/// A set of states such that beliefs from the initial belief on lie in one class at any time.
struct StateClass
{
  std::vector<std::uint32_t> states;  ///< ascending
  std::vector<ClassAction> actions;   ///< shape [num_actions]
  /// What the robot may not tell apart at the start only; nothing leads here. Its states may be in
  /// other classes too, which they are when the robot comes there later.
  bool start_only = false;
};

/// A belief that the robot may start with, in one class.
struct ObservedStart
{
  double probability;
  std::uint32_t state_class;
  std::vector<double> belief;  ///< shape [states of the class]
};

/// What ObservedModel throws when it is not to be finished.
struct Abandoned
{
};

/// A model as seen from its initial belief: states that cannot be reached are left out, and the
/// others fall into the finest classes that the robot can always tell apart (its own cell, say). So
/// what is fully observed is found without being declared, and beliefs and vectors get short. A
/// start that the robot knows less about (it may be in any cell) is a class of its own.
///
/// Source: the idea of mixed observability, Ong, Png, Hsu and Lee (2010).
class ObservedModel
{
public:
  /// @param find_classes  false: one class for all states, as if the robot always knew nothing
  /// @param keep_going    asked often; may be empty
  /// @throws Abandoned  `keep_going` said no
  explicit ObservedModel(const Model& model, bool find_classes = true,
                         const std::function<bool()>& keep_going = {});

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] double discount() const { return model_->discount(); }
  [[nodiscard]] std::size_t numActions() const { return model_->numActions(); }
  [[nodiscard]] const std::vector<StateClass>& classes() const { return classes_; }
  /// Its beliefs before the first action, never empty; probabilities sum to 1.
  [[nodiscard]] const std::vector<ObservedStart>& starts() const { return starts_; }

private:
  const Model* model_;  // outlives this object
  std::vector<StateClass> classes_;
  std::vector<ObservedStart> starts_;
};

}  // namespace kr3::pomdp
