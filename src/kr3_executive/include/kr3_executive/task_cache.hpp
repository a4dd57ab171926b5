#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>
#include <kr3_refinement/pomdp_task.hpp>
#include <kr3_refinement/zoom.hpp>

#include "kr3_executive/content_cache.hpp"

namespace kr3::executive
{

/// A state of the high level, as literals `f = v`, with what stands for its content.
struct HighLevelState
{
  std::vector<reasoner::Literal> literals;
  Fingerprint key;
};
[[nodiscard]] HighLevelState highLevelState(std::vector<reasoner::Literal> literals);

/// A zoom, with what stands for its content.
struct KnownZoom
{
  refinement::Zoom zoom;
  Fingerprint key;
};

/// What the low level makes of high-level actions: zooms, successors and generated POMDPs of one
/// domain with its models, by the content of the state, the action and the knowledge.
///
/// Thread-safe. The domain and the models must outlive it.
class TaskCache
{
public:
  TaskCache(const refinement::LowLevelDomain& domain, const refinement::Models& models)
    : domain_(domain), models_(models)
  {
  }

  [[nodiscard]] const refinement::LowLevelDomain& domain() const { return domain_; }

  /// refinement::zoom of a ground action. @throws FailedPrecondition  as there
  [[nodiscard]] std::shared_ptr<const KnownZoom> zoom(const HighLevelState& state,
                                                      const std::string& action);
  /// refinement::successor of a ground action. @throws FailedPrecondition  as there
  [[nodiscard]] std::shared_ptr<const HighLevelState> successor(const HighLevelState& state,
                                                                const std::string& action);
  /// refinement::generatePomdp
  [[nodiscard]] std::shared_ptr<const refinement::PomdpTask> task(
      const KnownZoom& zoom, const refinement::InitialKnowledge& knowledge);

  [[nodiscard]] ContentCacheStats zoomStats() const { return zooms_.stats(); }
  [[nodiscard]] ContentCacheStats successorStats() const { return successors_.stats(); }
  [[nodiscard]] ContentCacheStats taskStats() const { return tasks_.stats(); }

private:
  /// What a computation gave, or why it was refused.
  template <typename Value>
  struct Outcome
  {
    std::shared_ptr<const Value> value;
    std::string refusal;
  };

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  ContentCache<Outcome<KnownZoom>> zooms_;
  ContentCache<Outcome<HighLevelState>> successors_;
  ContentCache<std::shared_ptr<const refinement::PomdpTask>> tasks_{512U << 20U};
};

}  // namespace kr3::executive
