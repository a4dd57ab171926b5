#include "kr3_executive/method.hpp"

#include <optional>
#include <utility>

#include <kr3_common/error.hpp>

#include "belief_mission.hpp"
#include "flat_controller.hpp"
#include "hierarchical_controller.hpp"
#include "online_controller.hpp"

namespace kr3::executive
{
namespace
{

/// A gap between the bounds, as a part of what a mission can win or lose, at which a policy that
/// was solved ahead is kept.
constexpr double kGoodGap = 0.02;

std::unique_ptr<Mission> beliefMission(MissionParts parts, const BaselineOptions& options,
                                       std::optional<double> default_probability,
                                       const std::shared_ptr<BaselineCache>& cache,
                                       const ControllerFactory& controllers)
{
  return std::make_unique<BeliefMission>(std::move(parts), options, default_probability, cache,
                                         controllers);
}

/// Follows a policy that was solved ahead; where that would give up, planning online has the last
/// word. Bounds at the start say little about beliefs that are unlikely from there, and there the
/// policy may not know better than to give up.
class BestController : public Controller
{
public:
  BestController(std::unique_ptr<Controller> ahead, std::unique_ptr<Controller> online)
    : ahead_(std::move(ahead)), online_(std::move(online))
  {
  }
  std::optional<std::size_t> next(const DomainBelief& belief,
                                  const std::atomic<bool>& cancel) override
  {
    const auto chosen = ahead_->next(belief, cancel);
    return chosen ? chosen : online_->next(belief, cancel);
  }
  [[nodiscard]] std::string description() const override { return ahead_->description(); }

private:
  std::unique_ptr<Controller> ahead_;
  std::unique_ptr<Controller> online_;
};

/// POMDP-1: solved ahead where that gives a good policy, else planned online.
ControllerFactory flatControllers(const MissionParts& parts, const BaselineOptions& options,
                                  const std::shared_ptr<BaselineCache>& cache)
{
  PolicyServer& policies = parts.policies;
  const double threshold = parts.config.limits.threshold;
  return [&policies, options, threshold, cache](
             const DomainBelief& start, const reasoner::Formula& goal,
             const std::atomic<bool>& cancel) -> std::unique_ptr<Controller> {
    if (options.planning != FlatPlanning::kOnline)
    {
      try
      {
        auto ahead = std::make_unique<FlatController>(start, goal, threshold, policies, options,
                                                      cache, cancel);
        if (options.planning == FlatPlanning::kAhead)
          return ahead;
        if (ahead->relativeGap() <= kGoodGap)
        {
          return std::make_unique<BestController>(
              std::move(ahead),
              std::make_unique<OnlineController>(start, goal, threshold, options, cache));
        }
      }
      catch (const ResourceExhausted&)
      {
        if (options.planning == FlatPlanning::kAhead)
          throw;
      }
    }
    return std::make_unique<OnlineController>(start, goal, threshold, options, cache);
  };
}

ControllerFactory hierarchicalControllers(const MissionParts& parts, const BaselineOptions& options,
                                          const std::shared_ptr<BaselineCache>& cache)
{
  PolicyServer& policies = parts.policies;
  return [&policies, options, config = parts.config, cache](
             const DomainBelief& start, const reasoner::Formula& goal,
             const std::atomic<bool>& cancel) -> std::unique_ptr<Controller> {
    return std::make_unique<HierarchicalController>(start, goal, policies, config, options, cache,
                                                    cancel);
  };
}

}  // namespace

const std::vector<Method>& allMethods()
{
  static const std::vector<Method> kAll{Method::kPa, Method::kPaStar, Method::kPomdp1,
                                        Method::kPomdp2, Method::kHierarchical};
  return kAll;
}

const char* toString(Method method)
{
  switch (method)
  {
    case Method::kPa:
      return "pa";
    case Method::kPaStar:
      return "pa_star";
    case Method::kPomdp1:
      return "pomdp1";
    case Method::kPomdp2:
      return "pomdp2";
    case Method::kHierarchical:
      return "hierarchical";
  }
  return "unknown";
}

Method methodNamed(const std::string& name)
{
  std::string known;
  for (const Method method : allMethods())
  {
    if (name == toString(method))
      return method;
    known += (known.empty() ? "" : ", ") + std::string(toString(method));
  }
  throw InvalidArgument("method '" + name + "', expected one of " + known);
}

const char* toString(FlatPlanning planning)
{
  switch (planning)
  {
    case FlatPlanning::kBest:
      return "best";
    case FlatPlanning::kAhead:
      return "ahead";
    case FlatPlanning::kOnline:
      return "online";
  }
  return "unknown";
}

FlatPlanning flatPlanningNamed(const std::string& name)
{
  for (const FlatPlanning planning :
       {FlatPlanning::kBest, FlatPlanning::kAhead, FlatPlanning::kOnline})
  {
    if (name == toString(planning))
      return planning;
  }
  throw InvalidArgument("flat planning '" + name + "', expected best, ahead or online");
}

reasoner::Description descriptionFor(Method method, const reasoner::Description& high_level)
{
  reasoner::Description description = high_level;
  if (method != Method::kPa && method != Method::kPomdp2)
  {
    description.defaults.clear();
    description.preferences.clear();
  }
  return description;
}

std::shared_ptr<BaselineCache> makeBaselineCache()
{
  return std::make_shared<BaselineCache>();
}

std::unique_ptr<Mission> makeMission(Method method, MissionParts parts,
                                     const BaselineOptions& options,
                                     std::shared_ptr<BaselineCache> cache)
{
  if (!(options.default_probability > 0.0 && options.default_probability < 1.0))
  {
    throw InvalidArgument("default probability " + std::to_string(options.default_probability) +
                          ", expected (0, 1)");
  }
  if (!cache)
    cache = makeBaselineCache();
  switch (method)
  {
    case Method::kPa:
    case Method::kPaStar:
      return std::make_unique<MissionDriver>(
          parts.domain, parts.models, parts.narrator, parts.reasoner, parts.policies,
          parts.executor, parts.observer, parts.clock, parts.config, parts.costs);
    case Method::kPomdp1:
    case Method::kPomdp2:
    {
      const ControllerFactory controllers = flatControllers(parts, options, cache);
      return beliefMission(
          std::move(parts), options,
          method == Method::kPomdp2 ? std::optional(options.default_probability) : std::nullopt,
          cache, controllers);
    }
    case Method::kHierarchical:
    {
      const ControllerFactory controllers = hierarchicalControllers(parts, options, cache);
      return beliefMission(std::move(parts), options, std::nullopt, cache, controllers);
    }
  }
  throw InternalError("a method without missions");
}

}  // namespace kr3::executive
