#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <kr3_pomdp/model.hpp>
#include <kr3_reasoner/transition_system.hpp>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
#include "kr3_refinement/zoom.hpp"

namespace kr3::refinement
{

/// The value of a fluent that lies outside the zoom: the object is not here.
inline const std::string kElsewhere = "elsewhere";
/// What is observed of a fluent with values, and believed of any, when it is not in the zoom.
inline const std::string kOutside = "outside";
/// The observation of an action that tells nothing.
inline const std::string kNoObservation = "none";

/// A distribution over values, by name.
using Distribution = std::map<std::string, double>;

/// What is known when a task starts. Fluents are named as in the language, "loc(tb1)". A fluent in
/// neither map has the value that s1 gives it, spread uniformly over its components; a boolean one
/// that s1 does not list is false.
struct InitialKnowledge
{
  /// Over low-level values; sums to 1. Mass on values outside the zoom, or on kElsewhere, goes to
  /// `elsewhere`.
  std::map<std::string, Distribution> fine;

  /// Over high-level values, each spread uniformly over its components; sums to at most 1. What is
  /// missing, and mass on values outside the zoom, goes to `elsewhere`. These fluents are hidden:
  /// they always have the value `elsewhere`.
  std::map<std::string, Distribution> coarse;
};

/// The POMDP of one high-level action, with what its indices mean.
///
/// States: the physical (inertial) fluents of the zoomed description, and two absorbing states:
/// `boundary` (an outcome left the zoom) and `done` (after `finish`). Actions: the ground low-level
/// actions and `finish`. Observations: "none"; "true" and "false" for `observes f = v` and boolean
/// fluents; the value's name for `observes f`, or "outside" for any value that is not in the zoom;
/// for an action with several observation laws these joined by ",". An immutable value.
class PomdpTask
{
public:
  enum class StateKind
  {
    kPhysical,
    kBoundary,
    kDone,
  };

  [[nodiscard]] const pomdp::Model& model() const { return model_; }
  [[nodiscard]] const Zoom& zoom() const { return zoom_; }

  /// The ground fluents that make up a physical state, with their values (`elsewhere` last where
  /// there is one).
  [[nodiscard]] const std::vector<reasoner::GroundFluent>& fluents() const { return fluents_; }
  [[nodiscard]] StateKind kind(std::size_t state) const;
  /// Indices of values, shape [fluents()]. @throws InvalidArgument  not a physical state
  [[nodiscard]] const reasoner::State& physicalState(std::size_t state) const;

  [[nodiscard]] std::size_t boundaryState() const { return states_.size(); }
  [[nodiscard]] std::size_t doneState() const { return states_.size() + 1; }
  [[nodiscard]] std::size_t finishAction() const { return model_.numActions() - 1; }

  /// The observations that an action can give, by index into the model's.
  [[nodiscard]] const std::vector<std::size_t>& observationsOf(std::size_t action) const
  {
    return observations_of_.at(action);
  }
  /// The ground action as in the language, "search(rob1, c1, tb1)" (the model's own names have no
  /// blanks); "finish".
  [[nodiscard]] const std::string& actionText(std::size_t action) const
  {
    return action_texts_.at(action);
  }
  /// The action's name among the domain's actions ("search" of "search(rob1, c1, tb1)"); "finish"
  /// for finish.
  [[nodiscard]] const std::string& actionSymbol(std::size_t action) const
  {
    return action_symbols_.at(action);
  }
  [[nodiscard]] const std::vector<std::string>& actionArguments(std::size_t action) const
  {
    return action_arguments_.at(action);
  }

  /// The ground fluents that the action's observation laws are about, "loc(tb1)", in the order in
  /// which its observations name what is told of them; none for finish.
  [[nodiscard]] const std::vector<std::string>& observedFluents(std::size_t action) const
  {
    return observed_fluents_.at(action);
  }
  /// Of each of them, whether a law lets the action change it: what is told is feedback then, and
  /// true even of an attempt that is impossible. Shape [observedFluents(action)].
  [[nodiscard]] const std::vector<bool>& isFeedback(std::size_t action) const
  {
    return feedback_.at(action);
  }
  /// The action can be carried out in the state: no law forbids it, and there is a way. `finish`
  /// can in all but the done state, nothing else in the boundary.
  [[nodiscard]] bool isExecutable(std::size_t action, std::size_t state) const;

  /// The high-level action's effects hold in the state / with which probability they hold.
  [[nodiscard]] bool isSuccess(std::size_t state) const { return success_.at(state); }
  [[nodiscard]] double successProbability(const pomdp::Belief& belief) const;
  /// No sequence of low-level actions leads to the effects from here (elsewhere, boundary) / with
  /// which probability.
  [[nodiscard]] bool isHopeless(std::size_t state) const { return hopeless_.at(state); }
  [[nodiscard]] double hopelessProbability(const pomdp::Belief& belief) const;

  /// Belief over the values of a ground fluent, "loc(tb1)"; `elsewhere` is a value, and mass in the
  /// boundary is under "outside". The mass of `done` is left out and the rest scaled to 1.
  /// @throws NotFound            no such fluent in the zoom
  /// @throws FailedPrecondition  all mass is in `done`
  [[nodiscard]] Distribution fineMarginal(const pomdp::Belief& belief,
                                          const std::string& fluent) const;
  /// The same over the high level's values.
  [[nodiscard]] Distribution coarseMarginal(const pomdp::Belief& belief,
                                            const std::string& fluent) const;

  /// The coarse fluents of the zoom, for coarseMarginal: "loc(rob1)", "in_hand(rob1, tb1)".
  [[nodiscard]] std::vector<std::string> coarseFluents() const;

  /// The belief in a line for people: "loc(rob1) = c1; loc(tb1): c2 0.61, elsewhere 0.30, c1 0.09".
  [[nodiscard]] std::string summary(const pomdp::Belief& belief) const;

private:
  friend class TaskGenerator;
  PomdpTask(pomdp::Model model, Zoom zoom) : model_(std::move(model)), zoom_(std::move(zoom)) {}

  [[nodiscard]] Distribution marginal(const pomdp::Belief& belief,
                                      const std::vector<std::size_t>& fluents, bool coarse) const;

  pomdp::Model model_;
  Zoom zoom_;
  std::vector<reasoner::GroundFluent> fluents_;
  std::vector<reasoner::State> states_;
  std::vector<std::vector<std::size_t>> observations_of_;
  std::vector<std::string> action_texts_;
  std::vector<std::string> action_symbols_;
  std::vector<std::vector<std::string>> action_arguments_;
  std::vector<std::vector<std::string>> observed_fluents_;  // [action]
  std::vector<std::vector<bool>> feedback_;                 // [action][observed fluent]
  std::vector<std::vector<bool>> executable_;               // [action][physical state]
  std::vector<bool> success_;
  std::vector<bool> hopeless_;
  std::map<std::string, std::string> coarse_of_;  // component -> whole, of the zoom's constants
  std::map<std::string, std::vector<std::size_t>>
      coarse_fluents_;  // coarse name -> indices into fluents_
};

struct GeneratorLimits
{
  std::size_t max_states = 100000;
};

/// The POMDP of a zoom (docs/refinement.md).
///
/// @throws InvalidArgument     knowledge names an unknown fluent or value, or is no distribution;
///                             an action without a model, or outcomes that do not sum to 1
/// @throws FailedPrecondition  no state of the zoomed description fits the knowledge; a value is
///                             neither in the knowledge nor in s1
/// @throws ResourceExhausted   more states than the limit
[[nodiscard]] PomdpTask generatePomdp(const LowLevelDomain& domain, const Models& models,
                                      const Zoom& zoom, const InitialKnowledge& knowledge,
                                      const GeneratorLimits& limits = {});

}  // namespace kr3::refinement
