#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_pomdp/model.hpp>

#include "kr3_refinement/models.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{

/// The names of observations, numbered as they come up; "none" is 0.
class ObservationNames
{
public:
  ObservationNames() { number(kNoObservation); }
  std::uint32_t number(const std::string& name);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

/// What one ground action tells, by the state in which it ends: the product of its observation
/// laws' sensor models. Not thread-safe (it remembers rows).
class SensorTable
{
public:
  /// @param names  receives the observations; it and the others must outlive this object
  SensorTable(const Semantics& semantics, const Models& models, const GroundAction& action,
              ObservationNames& names);

  [[nodiscard]] const std::vector<GroundObservation>& laws() const { return laws_; }

  /// O(. | action, state), by ascending observation; sums to 1.
  ///
  /// @param state   nullptr for the boundary
  /// @param really  the action was carried out to come here; otherwise it was impossible, and only
  ///                feedback on its own effects is true: the rest is told as if it were not so
  [[nodiscard]] const std::vector<pomdp::SparseEntry>& row(const Values* state, bool really);

private:
  /// A distribution over what is told, by name.
  using Told = std::map<std::string, double>;

  [[nodiscard]] Told told(std::size_t law, int value, bool really) const;
  [[nodiscard]] Told toldValue(std::size_t law, int value, bool informative) const;

  const Semantics& semantics_;
  std::vector<GroundObservation> laws_;
  std::vector<const ObservationModel*> models_;  // of each law
  std::vector<bool> feedback_;                   // of each law: the action affects the fluent
  ObservationNames& names_;
  std::map<std::vector<int>, std::vector<pomdp::SparseEntry>> rows_;  // by what they depend on
};

}  // namespace kr3::refinement
