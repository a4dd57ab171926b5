#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/mission_script.hpp"

namespace kr3::executive
{

/// A ground action as the language writes it: "search(rob1, c1, tb1)".
[[nodiscard]] std::string canonicalText(const LowLevelAction& action);

/// An abstract world in which the interventions of a script happen.
///
/// What cannot be done as the script says is kept in problems(), and the low-level action fails
/// with InvalidArgument. Not thread-safe. Everything passed by reference must outlive it.
class ScriptedWorld : public LowLevelExecutor
{
public:
  using Tell = std::function<void(const reasoner::Record&)>;

  /// @param world        shared with whoever asks it for the truth
  /// @param high_level   text of the high-level action under execution
  /// @param tell         takes what a person says; called during execute()
  ScriptedWorld(const refinement::LowLevelDomain& domain, AbstractWorld& world,
                const MissionScript& script, std::function<std::string()> high_level, Tell tell,
                std::uint64_t seed);

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;

  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }
  /// Places of interventions that never happened.
  [[nodiscard]] std::vector<std::string> unused() const;

private:
  [[nodiscard]] bool applies(std::size_t index, const LowLevelAction& action);
  [[nodiscard]] FluentValues drawn(const std::vector<WorldChange>& changes);
  void let(const Happening& happening);
  [[nodiscard]] LowLevelResult perform(const LowLevelAction& action,
                                       const std::vector<const Intervention*>& now);
  [[nodiscard]] std::vector<Sighting> noticed(const Notice& notice,
                                              const LowLevelAction& action) const;

  const refinement::LowLevelDomain& domain_;
  AbstractWorld& world_;
  const MissionScript& script_;
  std::function<std::string()> high_level_;
  Tell tell_;
  std::mt19937_64 random_;
  std::uint32_t number_ = 0;
  std::vector<std::uint32_t> occurrences_;  // of each intervention's trigger
  std::vector<std::uint32_t> happened_;     // how often each intervention took place
  std::vector<std::string> problems_;
};

}  // namespace kr3::executive
