#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "informed_bound.hpp"
#include "observed_model.hpp"
#include "upper_bound_source.hpp"

namespace kr3::pomdp
{

/// Upper bounds for searches: problems where a hidden thing keeps its value (the cell of an object,
/// the broken component) while the robot gathers information on it.
///
/// With noise-free sensors observations only rule values out, so that every belief is what the
/// prior leaves on some set of values. There are few such beliefs, and the optimum at all of them
/// is found by dynamic programming over sets in ascending order. A belief of the real problem is a
/// mixture of such beliefs over nested sets (its layers); the value function is convex, so the
/// mixture of their optima is an upper bound. Bounds that know nothing of the price of information
/// (MDP, fast informed bound) stay far above it.
class ExclusionBound : public UpperBoundSource
{
public:
  /// @param informed  upper bounds of the real model, for what ends the search
  /// @param keep_going   asked often; false gives nothing; may be empty
  /// @param most_values  more values than this are grouped
  /// @return nothing where it does not apply: no hidden value that stays, or the model is too large
  [[nodiscard]] static std::unique_ptr<ExclusionBound> make(const ObservedModel& real,
                                                            const InformedVectors& informed,
                                                            const std::function<bool()>& keep_going,
                                                            std::size_t most_values = 17);

  void advance() override;
  [[nodiscard]] bool finished() const override { return next_set_ == num_sets_; }
  [[nodiscard]] std::uint32_t version() const override { return finished() ? 1 : 0; }
  double upper(std::uint32_t state_class, const double* belief) override;
  [[nodiscard]] std::size_t sizeInBytes() const override;

private:
  using Set = std::uint32_t;  ///< of values: bit h stands for value h

  /// What remains of a set of values after an outcome, in the class that it leads to.
  struct Outcome
  {
    double weight;  ///< probability, discounted
    Set kept;
    std::uint32_t target;
  };
  struct SearchAction
  {
    /// Of each value, weighted by the prior: the reward and what comes after the search.
    std::vector<double> rewards;
    std::uint32_t future;  ///< in futures_
    double common;         ///< the reward where it is the same for all values, else NaN
  };
  /// A class of the noise-free model in which the search goes on.
  struct SearchClass
  {
    std::vector<SearchAction> actions;
    std::vector<double> corners;  ///< of each value, weighted by the prior
    Set possible = 0;
    std::vector<double> optima;  ///< by set, times the set's prior
  };
  /// A state of the real model: its prior, and an upper bound once it is known.
  struct Member
  {
    std::uint32_t state;
    double prior;
    double corner;
  };
  /// A value in a search class, with its states in the real model's class.
  struct Held
  {
    std::uint32_t search_class;
    std::uint32_t value;
    std::vector<Member> members;
  };
  /// The states of a class of the real model, as the search sees them.
  struct View
  {
    std::vector<Held> held;
    std::vector<Member> ended;
  };
  /// What an action leads to, at one set: what rules something out is known, the rest is not.
  struct Future
  {
    double known;
    double value;
    std::vector<std::pair<std::uint32_t, double>> same_set;  ///< class and weight
  };
  struct Layer
  {
    double ratio;
    std::uint32_t search_class;
    std::uint32_t value;
  };
  class Builder;

  ExclusionBound() = default;
  void solveSet(Set set);
  void openSet(Set set);
  double sweep(Set set);
  [[nodiscard]] double immediate(const SearchAction& action, Set set, double prior) const;

  std::vector<SearchClass> classes_;
  std::vector<std::vector<Outcome>> futures_;  // most actions of different classes share theirs
  std::vector<double> prior_;                  // of each value
  std::vector<View> views_;                    // by class of the real model
  double tolerance_ = 0.0;
  Set num_sets_ = 0;
  Set next_set_ = 1;
  // Scratch of solveSet() and upper().
  std::vector<Future> at_set_;
  std::vector<double> immediate_;  // by class and action
  std::vector<Layer> layers_;
};

}  // namespace kr3::pomdp
