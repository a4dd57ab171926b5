#include "kr3_executive/replay.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/solved_model.hpp>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/method.hpp"
#include "literal_text.hpp"
#include "replay_peers.hpp"
#include "typed_error.hpp"

namespace kr3::executive
{
namespace
{

/// Backups of a solve of which nothing is recorded and that only time was to end.
constexpr std::uint64_t kUnrecordedBackups = 5000;

/// Cut short, and no counted work says where.
bool isUnrepeatable(const ReportedDecision& decision)
{
  return decision.cut_short && (!decision.policy || decision.policy->backups == 0);
}

/// The texts to reason with. @param differences  receives a line for each that was not recorded so
DomainFiles filesOf(const RecordedMission& mission, const ReplayOptions& options,
                    std::vector<std::string>& differences)
{
  if (options.domain.empty())
    return mission.domain;
  const std::string folder = options.domain + "/";
  DomainFiles files =
      readDomainFiles(folder + mission.domain.domain.name, folder + mission.domain.refinement.name,
                      folder + mission.domain.models.name, folder + mission.domain.bindings.name,
                      mission.domain.map);
  const auto compare = [&](const DomainFile& recorded, const DomainFile& now) {
    const std::string then_hash = pomdp::contentHash(recorded.text);
    const std::string now_hash = pomdp::contentHash(now.text);
    if (then_hash != now_hash)
      differences.push_back(folder + now.name + " is not the recorded file: its hash is " +
                            now_hash + ", recorded was " + then_hash);
  };
  compare(mission.domain.domain, files.domain);
  compare(mission.domain.refinement, files.refinement);
  compare(mission.domain.models, files.models);
  compare(mission.domain.bindings, files.bindings);
  return files;
}

ReasonerSettings settingsOf(const RecordedMission& mission)
{
  return mission.start.reasoner.value_or(ReasonerSettings{});
}

bool isSameChoice(const ReportedDecision& a, const ReportedDecision& b)
{
  return a.kind == b.kind && a.details == b.details;
}

/// One replay: stands between a mission and a recording. It observes the mission, and it is what
/// the mission executes on.
class Replayer : public MissionObserver, public LowLevelExecutor
{
public:
  Replayer(const RecordedMission& mission, const ReplayOptions& options)
    : mission_(mission)
    , options_(options)
    , loaded_(load(filesOf(mission, options, result_.not_promised)))
    , narrator_(loaded_.bindings.phrases())
    , reasoner_(descriptionFor(mission.method.method, loaded_.domain->highLevel()), mission.plan,
                settingsOf(mission), interruption_)
    , policies_([this](const SolveBudget& budget) { return counted(budget); },
                [this] { return isPolicyLost(); }, interruption_)
    , mission_again_(makeMission(mission.method.method,
                                 {*loaded_.domain, loaded_.models, narrator_, reasoner_, policies_,
                                  *this, *this, [this] { return now_s_; }, mission.start.config},
                                 mission.method.baseline))
    , now_s_(mission.start_s)
  {
    tellDoubts();
    skipFactsOutside();
  }

  ReplayResult run()
  {
    const MissionBegun& start = mission_.start;
    mission_again_->setKnowledge(start.knowledge);
    static_cast<void>(
        mission_again_->achieve(start.goal, start.initial, start.limits, start.time_limit_s));
    if (result_.end == ReplayEnd::kMissionEnded && !diverged_ && next_ < mission_.items.size())
    {
      // It ended, and the recorded one went on.
      const auto* decision = std::get_if<ReportedDecision>(&mission_.items[next_].content);
      add({Verdict::kDiffers, mission_.items[next_].sequence, step_, hl_action_,
           decision == nullptr ? std::nullopt : std::make_optional(*decision), std::nullopt});
    }
    return std::move(result_);
  }

  void onEvent(const ReportedEvent& event) override
  {
    step_ = static_cast<int>(event.hl_step);
    hl_action_ = event.hl_action;
  }
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& snapshot) override
  {
    step_ = snapshot.state.step;
    hl_action_ = snapshot.state.currentAction();
    history_step_ = currentStep(snapshot.history);
  }

  void onDecision(const ReportedDecision& decision) override
  {
    if (isOver())
      return;
    ReplayedDecision replayed{Verdict::kNew, sequence(), step_, hl_action_, {}, decision};
    if (!diverged_)
    {
      if (next_ == mission_.items.size())
      {
        end(ReplayEnd::kRecordingEnded, "the recording ends here");
        return;
      }
      if (const auto* recorded = std::get_if<ReportedDecision>(&mission_.items[next_].content))
        replayed.recorded = *recorded;
      const bool same = replayed.recorded && isSameChoice(*replayed.recorded, decision);
      replayed.verdict = !same                                        ? Verdict::kDiffers
                         : replayed.recorded->basis == decision.basis ? Verdict::kSame
                                                                      : Verdict::kOtherBasis;
      diverged_ = !same;
      if (replayed.recorded)
        consume();
    }
    add(std::move(replayed));
    interruption_.error = nullptr;
    anticipate();
  }

  void onInput(const Input& input) override
  {
    if (isOver() || std::holds_alternative<MissionBegun>(input) ||
        std::holds_alternative<SkillEnded>(input))  // taken from the recording in execute()
      return;
    if (const auto* told = std::get_if<FactTold>(&input); told != nullptr && !told->during_mission)
      return;
    if (const auto* refused = std::get_if<RequestRefused>(&input);
        refused != nullptr && !interruption_.error)
      result_.reason = "could not be computed here: " + refused->message;
    interruption_.error = nullptr;
    if (next_ < mission_.items.size())
    {
      const auto& content = mission_.items[next_].content;
      if (std::holds_alternative<FactTold>(input) ? std::holds_alternative<FactTold>(content)
                                                  : std::holds_alternative<RecordedEnd>(content))
        consume();
    }
    anticipate();
  }

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override
  {
    if (world_)
      return world_->execute(action, believed, cancel);
    if (diverged_)
      skipDecisions();
    const bool ended = next_ == mission_.items.size();
    const RecordedItem* item = ended ? nullptr : &mission_.items[next_];
    const auto* skill = item == nullptr ? nullptr : std::get_if<SkillEnded>(&item->content);
    if (skill != nullptr && skill->action.text == action.text)
    {
      const SkillEnded recorded = *skill;
      consume();
      if (recorded.code != ErrorCode::kOk)
        throwError(recorded.code, recorded.message);
      return recorded.result;
    }
    if (item != nullptr && std::holds_alternative<RecordedEnd>(item->content))
    {
      // It was interrupted while it was executed, or before it was tried again.
      mission_again_->cancel();
      interruption_.raise();
      throw Cancelled("as recorded");
    }
    if (options_.continue_with_seed)
    {
      enterWorld();
      return world_->execute(action, believed, cancel);
    }
    if (ended && !diverged_)
      end(ReplayEnd::kRecordingEnded, "the recording ends while " + action.text + " is executed");
    else
      end(ReplayEnd::kOtherAction,
          "nothing is recorded of " + action.text +
              (skill == nullptr ? "" : " here; the robot executed " + skill->action.text));
    throw Cancelled("the replay ends");
  }

private:
  static bool isDecision(const RecordedItem& item)
  {
    return std::holds_alternative<ReportedDecision>(item.content);
  }

  /// What in the recording need not repeat.
  void tellDoubts()
  {
    if (!mission_.start.reasoner)
    {
      result_.not_promised.emplace_back(
          "input 1: the reasoner did not tell its parameters; their defaults are used");
    }
    for (const auto& item : mission_.items)
    {
      const auto* decision = std::get_if<ReportedDecision>(&item.content);
      if (decision == nullptr || !isUnrepeatable(*decision))
        continue;
      result_.not_promised.push_back(
          "input " + std::to_string(item.sequence) +
          (decision->policy ? ": solving was ended by wall time before its first backup"
                            : ": wall time ended the search for more plans"));
    }
  }

  [[nodiscard]] bool isOver() const { return result_.end != ReplayEnd::kMissionEnded; }

  [[nodiscard]] std::uint32_t sequence() const
  {
    if (mission_.items.empty())
      return 1;
    return next_ < mission_.items.size() ? mission_.items[next_].sequence
                                         : mission_.items.back().sequence + 1;
  }

  void add(ReplayedDecision decision)
  {
    if (options_.on_decision)
      options_.on_decision(decision);
    result_.decisions.push_back(std::move(decision));
  }

  void end(ReplayEnd how, std::string reason)
  {
    result_.end = how;
    result_.reason = std::move(reason);
    mission_again_->cancel();
  }

  void consume()
  {
    now_s_ = std::max(now_s_, mission_.items[next_].stamp_s);
    ++next_;
    skipFactsOutside();
  }

  /// What was told after the mission's end is no part of it.
  void skipFactsOutside()
  {
    while (next_ < mission_.items.size())
    {
      const auto* told = std::get_if<FactTold>(&mission_.items[next_].content);
      if (told == nullptr || told->during_mission)
        return;
      ++next_;
    }
  }

  void skipDecisions()
  {
    while (next_ < mission_.items.size() && isDecision(mission_.items[next_]))
      consume();
  }

  /// Lets a fact or an interruption come from outside when it is next.
  void anticipate()
  {
    if (world_)
      return;
    if (diverged_)
      skipDecisions();
    if (next_ == mission_.items.size())
      return;
    const auto& content = mission_.items[next_].content;
    if (const auto* told = std::get_if<FactTold>(&content); told != nullptr && told_ != next_)
    {
      told_ = next_;
      mission_again_->tell(told->record);
    }
    const auto* decision = std::get_if<ReportedDecision>(&content);
    if (decision != nullptr && decision->cut_short &&
        decision->kind == reportedLateDiagnosis().kind)
      interruption_.error = [] { throw DeadlineExceeded("as recorded"); };
    const auto* ended = std::get_if<RecordedEnd>(&content);
    if (ended == nullptr)
      return;
    switch (ended->reason)
    {
      case RecordedEnd::Reason::kCancelled:
        mission_again_->cancel();
        interruption_.error = [] { throw Cancelled("as recorded"); };
        break;
      case RecordedEnd::Reason::kTime:
        now_s_ = std::max(now_s_, mission_.start_s + mission_.start.time_limit_s + 1.0);
        break;
      case RecordedEnd::Reason::kRefused:
        interruption_.error = [end = *ended] { throwError(end.code, end.message); };
        break;
    }
  }

  /// The recorded work where time ended a solve, else what was asked for without the time.
  [[nodiscard]] SolveBudget counted(const SolveBudget& budget) const
  {
    SolveBudget work = budget;
    work.time_s = 0.0;
    if (!diverged_ && next_ < mission_.items.size())
    {
      const auto* decision = std::get_if<ReportedDecision>(&mission_.items[next_].content);
      const auto& policy = decision == nullptr ? std::nullopt : decision->policy;
      const bool timed = policy && budget.time_s > 0.0 &&
                         (budget.max_backups == 0 || policy->backups < budget.max_backups) &&
                         policy->upper - policy->lower > budget.precision;
      if (timed && policy->backups > 0)
        work.max_backups = policy->backups;
      else if (timed)  // before the first backup: any precision will do
        work.precision = std::numeric_limits<double>::max();
    }
    if (work.max_backups == 0 && budget.time_s > 0.0)
      work.max_backups = kUnrecordedBackups;
    return work;
  }

  /// Whether the recorded policy server was asked for an action and had lost the policy, as after a
  /// restart: then the policy was solved again there.
  [[nodiscard]] bool isPolicyLost() const
  {
    if (diverged_ || next_ == mission_.items.size())
      return false;
    const auto* decision = std::get_if<ReportedDecision>(&mission_.items[next_].content);
    return decision != nullptr && decision->policy.has_value();
  }

  /// From what the robot knows now; the rest is as told in the options, or drawn.
  void enterWorld()
  {
    FluentValues coarse;
    const auto set = [&coarse](const std::string& text) {
      const LiteralText literal = takeApart(text);
      if (literal.equal)
        coarse[literal.fluent()] = literal.value;
    };
    for (const auto& literal : reasoner_.entailedAt(history_step_))
      set(literal);
    for (const auto& truth : options_.truths)
      set(reasoner::toString(reasoner::parseGroundLiteral(truth, loaded_.domain->highLevel())));
    world_ = std::make_unique<AbstractWorld>(*loaded_.domain, loaded_.models,
                                             *options_.continue_with_seed);
    world_->reset(coarse);
    diverged_ = true;
    next_ = mission_.items.size();
  }

  const RecordedMission& mission_;
  const ReplayOptions& options_;
  ReplayResult result_;
  LoadedDomain loaded_;
  Narrator narrator_;
  Interruption interruption_;
  InterruptedReasoner reasoner_;
  ReplayedPolicies policies_;
  std::unique_ptr<Mission> mission_again_;
  std::unique_ptr<AbstractWorld> world_;  // once the recording is left

  double now_s_;
  std::size_t next_ = 0;  // item of the recording
  std::optional<std::size_t> told_;
  bool diverged_ = false;  // after the first other choice
  int step_ = 0;
  int history_step_ = 0;
  std::string hl_action_;
};

}  // namespace

const char* toString(Verdict verdict)
{
  switch (verdict)
  {
    case Verdict::kSame:
      return "same";
    case Verdict::kOtherBasis:
      return "other numbers";
    case Verdict::kDiffers:
      return "differs";
    case Verdict::kNew:
      return "new";
  }
  return "unknown";
}

bool ReplayResult::isSame() const
{
  return firstDifference() == nullptr;
}

const ReplayedDecision* ReplayResult::firstDifference() const
{
  const auto found = std::find_if(decisions.begin(), decisions.end(), [](const auto& decision) {
    return decision.verdict != Verdict::kSame;
  });
  return found == decisions.end() ? nullptr : &*found;
}

const ReplayedDecision* ReplayResult::firstOtherChoice() const
{
  const auto found = std::find_if(decisions.begin(), decisions.end(), [](const auto& decision) {
    return decision.verdict == Verdict::kDiffers || decision.verdict == Verdict::kNew;
  });
  return found == decisions.end() ? nullptr : &*found;
}

ReplayResult replay(const RecordedMission& mission, const ReplayOptions& options)
{
  return Replayer(mission, options).run();
}

}  // namespace kr3::executive
