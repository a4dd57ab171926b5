#pragma once

#include <cstdint>
#include <map>
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
  ActionModelReader(YamlFile& file, const reasoner::Description& description,
                    reasoner::Atom action);

  /// @param key  the action's name in the file; its line stands for what is missing
  [[nodiscard]] ActionModel read(const YAML::Node& key, const YAML::Node& node);

private:
  using Counts = std::map<std::string, std::uint64_t>;

  [[nodiscard]] std::vector<std::string> labels() const;
  [[nodiscard]] std::vector<const reasoner::ObservationLaw*> observationLaws() const;

  ModelSource readSource(const std::string& what, const YAML::Node& node, const Counts& counts);
  Counts readCounts(const std::string& what, const YAML::Node& node,
                    const std::vector<std::string>& keys);
  void readOutcomes(const YAML::Node& key, const YAML::Node& node, ActionModel& model);
  void checkSum(const YAML::Node& node, const OutcomeModel& model);
  void readObservations(const YAML::Node& key, const YAML::Node& node, ActionModel& model);
  ObservationModel readObservation(const std::string& what, const YAML::Node& node,
                                   bool tells_value);
  void compare(const std::string& what, const YAML::Node& node, double probability,
               std::uint64_t count, std::uint64_t total);
  void readCost(const YAML::Node& key, const YAML::Node& node, CostModel& cost);
  void readDistance(const YAML::Node& node, CostModel& cost);

  YamlFile& file_;
  const reasoner::Description& description_;
  reasoner::Atom action_;
};

/// Whether an action's probabilities sum to 1: over all its outcomes, or over those of each law.
[[nodiscard]] bool sumsToOne(const OutcomeModel& model, const reasoner::Description& description,
                             const std::string& action);

/// `name` or `name(A, B)`; nothing when a text is neither.
[[nodiscard]] std::optional<reasoner::Atom> parsedAtom(const std::string& text);

}  // namespace kr3::refinement
