#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/models.hpp"
#include "yaml_file.hpp"

namespace kr3::refinement
{

/// Reads the numbers of one action from a models file and notes what does not fit its laws.
class ActionModelReader
{
public:
  /// @param action  with the names of its parameters, as the file gives them
  /// @param domain  nullptr: components are not of the classes of their wholes
  ActionModelReader(YamlFile& file, const reasoner::Description& description,
                    const LowLevelDomain* domain, reasoner::Atom action);

  /// @param key  the action's name in the file; its line stands for what is missing
  [[nodiscard]] ActionModel read(const YAML::Node& key, const YAML::Node& node);

private:
  using Counts = std::map<std::string, std::uint64_t>;

  [[nodiscard]] std::vector<std::string> labels() const;
  [[nodiscard]] std::vector<const reasoner::ObservationLaw*> observationLaws() const;

  // count_reader.cpp
  ModelSource readSource(const std::string& what, const YAML::Node& node, const Counts& counts);
  Counts readCounts(const std::string& what, const YAML::Node& node,
                    const std::vector<std::string>& keys);
  std::optional<double> readPrior(const std::string& what, const YAML::Node& node,
                                  const Counts& counts);
  void compareCounts(const std::string& what, const YAML::Node& node, const OutcomeModel& model);
  /// How likely the counts make it, or nothing when the probability fits them.
  static std::optional<double> contradicted(double probability, std::uint64_t count,
                                            std::uint64_t total, std::size_t values,
                                            std::optional<double> prior);
  void compare(const std::string& what, const YAML::Node& node, double probability,
               std::uint64_t count, std::uint64_t total, std::optional<double> prior);

  OutcomeModel readOutcomes(const std::string& what, const YAML::Node& key, const YAML::Node& node);
  void checkSum(const std::string& what, const YAML::Node& node, const OutcomeModel& model);
  [[nodiscard]] std::vector<std::string> observedFluents() const;
  [[nodiscard]] bool tellsValue(const std::string& fluent) const;
  void readObservations(const YAML::Node& key, const YAML::Node& node, ActionModel& model);
  ObservationModel readObservation(const std::string& what, const YAML::Node& node,
                                   bool tells_value);

  // cost_model_reader.cpp
  CostModel readCost(const YAML::Node& key, const YAML::Node& node);
  void readDuration(const std::string& what, const YAML::Node& node, CostModel& cost);
  void readDistance(const YAML::Node& node, CostModel& cost);

  // class_model_reader.cpp
  void readClasses(const YAML::Node& node, ActionModel& model);
  ClassModel readClass(const YAML::Node& node, const ActionModel& model);
  void readMembers(const YAML::Node& node, ClassModel& model);
  [[nodiscard]] std::set<std::string> membersOf(const std::string& name,
                                                const std::vector<std::string>& possible) const;
  void checkUnambiguous(const ActionModel& model);

  YamlFile& file_;
  const reasoner::Description& description_;
  const LowLevelDomain* domain_;
  reasoner::Atom action_;
};

/// Whether an action's probabilities sum to 1: over all its outcomes, or over those of each law.
[[nodiscard]] bool sumsToOne(const OutcomeModel& model, const reasoner::Description& description,
                             const std::string& action);

/// `name` or `name(A, B)`; nothing when a text is neither.
[[nodiscard]] std::optional<reasoner::Atom> parsedAtom(const std::string& text);

}  // namespace kr3::refinement
