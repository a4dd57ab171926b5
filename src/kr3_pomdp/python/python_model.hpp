#pragma once

#include "bindings.hpp"
#include "kr3_pomdp/online_planner.hpp"

namespace kr3::pomdp
{

/// Python objects that count as equal, numbered from 0.
class ObjectTable
{
public:
  /// @throws pybind11::error_already_set  an object that cannot be hashed
  [[nodiscard]] std::uint64_t numberOf(const pybind11::handle& object);
  [[nodiscard]] const pybind11::object& operator[](std::uint64_t number) const
  {
    return objects_[number];
  }

private:
  pybind11::dict numbers_;
  std::vector<pybind11::object> objects_;
};

/// A generative model that a Python object describes by its methods; states and observations are
/// any objects that can be hashed. Every call needs the interpreter's lock. What a method raises
/// goes through to the caller.
class PythonModel : public GenerativeModel
{
public:
  /// @throws InvalidArgument  a method is missing
  explicit PythonModel(pybind11::object model);

  [[nodiscard]] std::size_t numActions() const override { return num_actions_; }
  [[nodiscard]] double discount() const override { return discount_; }
  [[nodiscard]] GenerativeStep step(std::uint64_t state, std::size_t action,
                                    double random) const override;
  [[nodiscard]] double upperBound(std::uint64_t state) const override;
  [[nodiscard]] std::size_t defaultAction(const std::vector<std::uint64_t>& states) const override;
  [[nodiscard]] std::optional<double> observationProbability(
      std::size_t action, std::uint64_t next_state, std::uint64_t observation) const override;
  [[nodiscard]] std::optional<std::uint64_t> perturbed(std::uint64_t state,
                                                       double random) const override;

  [[nodiscard]] std::uint64_t stateNumber(const pybind11::handle& state) const
  {
    return states_.numberOf(state);
  }
  [[nodiscard]] std::uint64_t observationNumber(const pybind11::handle& observation) const
  {
    return observations_.numberOf(observation);
  }
  [[nodiscard]] const pybind11::object& state(std::uint64_t number) const
  {
    return states_[number];
  }
  /// Forgets all states but these, and all observations. @return the new numbers of these
  std::vector<std::uint64_t> keepOnly(const std::vector<std::uint64_t>& states);

private:
  pybind11::object model_;
  std::size_t num_actions_;
  double discount_;
  pybind11::object step_;
  pybind11::object upper_bound_;
  pybind11::object default_action_;           // None: action 0, as in the next
  pybind11::object observation_probability_;  // None: not known
  pybind11::object perturbed_;
  mutable ObjectTable states_;  // grow as sampling meets new ones
  mutable ObjectTable observations_;
};

}  // namespace kr3::pomdp
