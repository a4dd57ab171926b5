#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "baseline_cache.hpp"
#include "controller.hpp"
#include "kr3_executive/method.hpp"

namespace kr3::executive
{

/// A mission by a probabilistic method: one belief over the whole domain, updated after each
/// low-level action, and a controller that chooses the next. It ends when the controller holds
/// ending for better than going on, and declares the goal then if that is likelier than not; it
/// ends without it after as many low-level actions as Algorithm 1 may make in all.
class BeliefMission : public Mission
{
public:
  /// @param default_probability  nothing: defaults are not used
  BeliefMission(MissionParts parts, BaselineOptions options,
                std::optional<double> default_probability, std::shared_ptr<BaselineCache> cache,
                ControllerFactory controllers);

  MissionResult achieve(const std::string& goal, const std::vector<reasoner::Record>& initial,
                        const Limits& limits, double time_limit_s) override;
  void cancel() override { cancel_ = true; }
  void tell(const reasoner::Record& record) override;
  [[nodiscard]] const Knowledge& knowledge() const override { return knowledge_; }
  void setKnowledge(Knowledge knowledge) override;

private:
  [[nodiscard]] DomainBelief startBelief(const std::string& goal);
  Finish run(const reasoner::Formula& goal, const Limits& limits, double time_limit_s);
  [[nodiscard]] LowLevelResult execute(const LowLevelAction& action);
  void takeInTold();
  void takeIn(const reasoner::Record& record);
  void report(EventKind kind, Narration narration);
  void reportBelief();
  void publish(const std::string& ll_action);
  void note(const Input& input);
  void noteDecision(const std::string& kind, const std::string& detail);

  MissionParts parts_;
  BaselineOptions options_;
  std::optional<double> default_probability_;
  std::shared_ptr<BaselineCache> cache_;
  ControllerFactory controllers_;

  Knowledge knowledge_;
  State state_;
  std::optional<DomainBelief> belief_;
  std::unique_ptr<Controller> controller_;
  std::uint32_t sequence_ = 0;
  std::uint32_t num_decisions_ = 0;

  std::atomic<bool> cancel_{false};
  std::atomic<bool> running_{false};
  std::mutex mission_mutex_;  // held while a mission runs
  std::mutex told_mutex_;
  std::vector<reasoner::Record> told_;
};

}  // namespace kr3::executive
