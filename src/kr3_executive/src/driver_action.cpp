// The part of MissionDriver that carries out one high-level action on the low level (lines 9-15).

#include <algorithm>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/driver.hpp"
#include "literal_text.hpp"
#include "mission_inputs.hpp"

namespace kr3::executive
{
namespace
{

constexpr double kEvenChance = 0.5;
constexpr double kMostCertain = 0.999;  // of a record that rests on a belief

}  // namespace

Event MissionDriver::performPolicy(const RequestPolicy& request)
{
  try
  {
    task_state_ = believedState(state_.plan->plan.hypothesis);
    const auto zoom = costs_->tasks().zoom(highLevelState(task_state_), request.action);
    auto knowledge = initialKnowledge(domain_, zoom->zoom, knowledge_.memory,
                                      [this](const std::string& l) { return supportOf(l); });
    allowForChange(zoom->zoom, knowledge);
    task_ =
        std::make_unique<LowLevelTask>(domain_, costs_->tasks().task(*zoom, knowledge), knowledge);
  }
  catch (const FailedPrecondition& e)
  {
    report(EventKind::kPolicy,
           [&] { return Narration{"no policy for " + request.action + ": " + e.what()}; });
    return ActionImpossible{e.what(), situationOf(request.action)};
  }
  const SolvedPolicy policy = solvePolicy(request.action);
  report(EventKind::kPolicy,
         [&] { return narrator_.policy(request.action, policy, task_->pomdp()); });
  return PolicyReady{task_->assess(), situationOf(request.action)};
}

SolvedPolicy MissionDriver::solvePolicy(const std::string& action)
{
  const SolvedPolicy policy = policies_.solve(task_->pomdp().model(), config_.budget, cancel_);
  policy_id_ = policy.id;
  observer_.onPolicy(policy);
  note([&] {
    ReportedDecision decision = reported(action, policy, task_->belief());
    decision.cut_short = policy.isCutShort(config_.budget);
    return decision;
  });
  return policy;
}

Event MissionDriver::performAction()
{
  std::size_t index = 0;
  try
  {
    index = policies_.actionAt(policy_id_, task_->belief());
  }
  catch (const NotFound&)  // the server was restarted: tell it again
  {
    static_cast<void>(solvePolicy(state_.currentAction()));
    index = policies_.actionAt(policy_id_, task_->belief());
  }
  const bool finishes = task_->isFinish(index);
  note([&] {
    return reportedLowLevel(finishes ? std::string() : task_->action(index).text, task_->belief());
  });
  if (finishes)
    return PolicyFinished{assessed()};

  const LowLevelAction action = task_->action(index);
  ll_action_ = action.text;
  publish();
  LowLevelResult result;
  try
  {
    result = execute(action);
  }
  catch (const FailedPrecondition& e)  // the robot is not as the belief has it
  {
    ll_action_.clear();
    return TaskLost{action.text + " was refused: " + e.what(), assessed()};
  }
  ll_action_.clear();
  const bool explained = task_->update(index, result.observation, result.confidence);
  const std::vector<std::string> ignored = takeInSightings(result.sightings);
  task_->remember(knowledge_.memory);
  report(EventKind::kLowLevelAction,
         [&] { return narrator_.lowLevelAction(action, result, *task_, ignored); });
  publishBelief();
  return afterObservation(action, explained);
}

void MissionDriver::publishBelief()
{
  if (!interest_.narration)
    return;
  ReportedBelief belief{state_.currentAction(),
                        static_cast<std::uint32_t>(state_.step),
                        {},
                        task_->pomdp().summary(task_->belief())};
  for (const auto& fluent : task_->pomdp().fluents())
    belief.fluents[fluent.name] = task_->pomdp().fineMarginal(task_->belief(), fluent.name);
  observer_.onBelief(belief);
}

void MissionDriver::allowForChange(const refinement::Zoom& zoom,
                                   refinement::InitialKnowledge& knowledge) const
{
  const double doubt = config_.change_probability;
  for (const auto& literal : zoom.start)
  {
    const std::string fluent = reasoner::toString(literal.atom);
    const bool boolean = literal.value.name == "true" || literal.value.name == "false";
    if (boolean || !literal.equal || !mayHaveChanged(fluent))
      continue;
    const auto fine = knowledge.fine.find(fluent);
    const auto coarse = knowledge.coarse.find(fluent);
    if (fine != knowledge.fine.end())
    {
      double& elsewhere = fine->second[refinement::kElsewhere];
      if (elsewhere >= doubt)
        continue;
      const double scale = (1.0 - doubt) / (1.0 - elsewhere);
      elsewhere = 0.0;
      for (auto& entry : fine->second)
        entry.second *= scale;
      fine->second[refinement::kElsewhere] = doubt;
    }
    else if (coarse == knowledge.coarse.end())
      knowledge.coarse[fluent] = {{literal.value.name, 1.0 - doubt}};
    else if (double& here = coarse->second[literal.value.name]; here > 1.0 - doubt)
      here = 1.0 - doubt;
  }
}

std::vector<std::string> MissionDriver::takeInSightings(const std::vector<Sighting>& sightings)
{
  std::vector<std::string> ignored;
  for (const auto& sighting : sightings)
  {
    try
    {
      task_->notice(SightingLikelihood(domain_, sighting));
    }
    catch (const InvalidArgument& e)  // a skill's mistake is no reason to give the mission up
    {
      ignored.emplace_back(e.what());
    }
  }
  return ignored;
}

bool MissionDriver::concernsPlan(const std::vector<std::string>& constants) const
{
  if (!state_.plan)
    return false;
  const auto& steps = state_.plan->plan.steps;
  for (std::size_t i = state_.plan_index; i < steps.size(); ++i)
  {
    for (const auto& action : steps[i])
    {
      for (const auto& argument : takeApart(action).arguments)
      {
        if (std::find(constants.begin(), constants.end(), argument) != constants.end())
          return true;
      }
    }
  }
  return false;
}

std::optional<Noticed> MissionDriver::noticedOf(const std::string& fluent,
                                                const refinement::Distribution& values)
{
  const std::string whole = coarseFluent(domain_, fluent);
  const LiteralText parts = takeApart(whole);
  if (domain_.highLevel().findFluent(parts.symbol) == nullptr)
    return std::nullopt;  // the low level's own
  refinement::Distribution coarse;
  for (const auto& [value, probability] : values)
  {
    if (value != refinement::kElsewhere)
      coarse[domain_.coarse(value)] += probability;
  }
  const auto best =
      std::max_element(coarse.begin(), coarse.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (best == coarse.end() || best->second <= state_.limits.threshold)
    return std::nullopt;
  if (whole != fluent && best->first == "false")
    return std::nullopt;  // a part that is not so says nothing about its whole
  const bool boolean = best->first == "true" || best->first == "false";
  const std::string literal = !boolean                ? whole + " = " + best->first
                              : best->first == "true" ? whole
                                                      : "-" + whole;
  Noticed noticed{literal, std::min(best->second, kMostCertain), false};
  if (const auto belief = task_->beliefIn(whole, best->first))
  {
    noticed.overturns = *belief <= kEvenChance;
    return noticed.overturns ? std::optional(noticed) : std::nullopt;
  }
  const bool otherwise =
      std::any_of(task_state_.begin(), task_state_.end(), [&](const auto& known) {
        return reasoner::toString(known.atom) == whole && known.value.name != best->first;
      });
  noticed.overturns = otherwise && concernsPlan(parts.arguments);
  const bool same = std::any_of(task_state_.begin(), task_state_.end(), [&](const auto& known) {
    return reasoner::toString(known.atom) == whole && known.value.name == best->first;
  });
  if (same && supportOf(literal).probability >= noticed.confidence)
    return std::nullopt;  // nothing new
  return noticed;
}

Assessment MissionDriver::assessed()
{
  Assessment assessment = task_->assess();
  for (const auto& literal : literalsSeen(task_->observed()))
  {
    const std::string fluent = takeApart(literal).fluent();
    const bool concerned =
        std::any_of(assessment.effects.begin(), assessment.effects.end(),
                    [&](const auto& effect) { return takeApart(effect).fluent() == fluent; });
    if (concerned)
      assessment.seen.push_back(literal);
  }
  const std::vector<std::string> seen = literalsSeen(task_->observedLast());
  const auto isSeen = [&](const std::string& literal) {
    return std::find(seen.begin(), seen.end(), literal) != seen.end();
  };
  // What is observed by the action itself outweighs what is seen by the way.
  const bool sure = !assessment.effects.empty() &&
                    std::all_of(assessment.effects.begin(), assessment.effects.end(), isSeen);
  for (const auto& [fluent, values] : task_->noticed())
  {
    const auto noticed = noticedOf(fluent, values);
    if (!noticed)
      continue;
    const std::string whole = coarseFluent(domain_, fluent);
    const auto& hidden = assessment.refutations;
    const bool in_zoom = task_->beliefIn(whole, "").has_value();
    const bool doubtful = std::any_of(hidden.begin(), hidden.end(), [&](const auto& refutation) {
      return takeApart(refutation.literal).fluent() == whole;
    });
    if (in_zoom && sure)
      continue;
    assessment.denied = assessment.denied || (in_zoom && !doubtful);
    assessment.noticed.push_back(*noticed);
  }
  if (assessment.denied)
  {
    assessment.changed = changesAmong(literalsSeen(task_->observed()), {});
    assessment.happened = happened(assessment.changed);
  }
  return assessment;
}

LowLevelResult MissionDriver::execute(const LowLevelAction& action)
{
  const FluentLookup believed = [this](const std::string& fluent) { return believedValue(fluent); };
  return executeNoting(executor_, action, believed, config_.max_skill_retries, cancel_,
                       [this](const Input& input) { note(input); });
}

std::string MissionDriver::believedValue(const std::string& fluent) const
{
  refinement::Distribution values;
  const auto& zoomed = task_->pomdp().fluents();
  if (std::any_of(zoomed.begin(), zoomed.end(), [&](const auto& f) { return f.name == fluent; }))
    values = task_->pomdp().fineMarginal(task_->belief(), fluent);
  else if (const auto found = knowledge_.memory.find(fluent); found != knowledge_.memory.end())
    values = found->second.values;
  const auto most =
      std::max_element(values.begin(), values.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == values.end() || most->first == refinement::kElsewhere ? std::string()
                                                                       : most->first;
}

std::vector<std::string> MissionDriver::literalsSeen(
    const std::map<std::string, std::string>& observed) const
{
  std::vector<std::string> seen;
  for (const auto& [fluent, value] : observed)
  {
    const std::string whole = coarseFluent(domain_, fluent);
    const auto* declared = domain_.highLevel().findFluent(takeApart(whole).symbol);
    if (declared == nullptr || (whole != fluent && value == "false"))
      continue;  // a part that is not so says nothing about its whole
    if (declared->value_sort)
      seen.push_back(whole + " = " + domain_.coarse(value));
    else
      seen.push_back(value == "true" ? whole : "-" + whole);
  }
  return seen;
}

std::vector<std::string> MissionDriver::changesAmong(const std::vector<std::string>& seen,
                                                     const std::vector<std::string>& effects) const
{
  std::vector<std::string> changed;
  for (const auto& literal : seen)
  {
    const bool before = std::any_of(task_state_.begin(), task_state_.end(), [&](const auto& known) {
      return reasoner::toString(known) == literal;
    });
    const bool after = std::find(effects.begin(), effects.end(), literal) != effects.end();
    if (!before && !after && takeApart(literal).value != "false")
      changed.push_back(literal);
  }
  return changed;
}

Event MissionDriver::afterObservation(const LowLevelAction& action, bool explained)
{
  Assessment assessment = assessed();
  if (explained || assessment.denied)
    return ActionExecuted{action.text, std::move(assessment)};

  // The zoomed model has no place for what was seen: judge by what was observed alone.
  const std::vector<std::string> seen = literalsSeen(task_->observed());
  const auto isSeen = [&](const std::string& literal) {
    return std::find(seen.begin(), seen.end(), literal) != seen.end();
  };
  if (!assessment.effects.empty() &&
      std::all_of(assessment.effects.begin(), assessment.effects.end(), isSeen))
  {
    assessment.achieved = 1.0;
    return ActionExecuted{action.text, std::move(assessment)};
  }
  assessment.changed = changesAmong(seen, assessment.effects);
  if (assessment.changed.empty())
  {
    return TaskLost{"what was observed is impossible in the model of " + state_.currentAction(),
                    std::move(assessment)};
  }
  assessment.happened = happened(assessment.changed);
  return ActionExecuted{action.text, std::move(assessment)};
}

std::optional<std::string> MissionDriver::happened(const std::vector<std::string>& changed) const
{
  FluentValues before;
  for (const auto& literal : task_state_)
    before[reasoner::toString(literal.atom)] = literal.value.name;
  std::vector<reasoner::Literal> wanted;
  for (const auto& text : changed)
    wanted.push_back(reasoner::parseGroundLiteral(text, domain_.highLevel()));
  const OutcomeChooser first{[](const auto&, const auto&) { return std::size_t{0}; },
                             [](std::size_t) { return std::size_t{0}; }};
  for (const auto& declaration : domain_.highLevel().actions)
  {
    if (declaration.exogenous)
      continue;
    for (const auto& action : high_level_laws_.instances(declaration))
    {
      if (!high_level_laws_.executable(before, action))
        continue;
      const FluentValues after = high_level_laws_.successor(before, action, first);
      if (std::all_of(wanted.begin(), wanted.end(),
                      [&](const auto& literal) { return high_level_laws_.holds(after, literal); }))
        return reasoner::toString(action);
    }
  }
  return std::nullopt;
}

}  // namespace kr3::executive
