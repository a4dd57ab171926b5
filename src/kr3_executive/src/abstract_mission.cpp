#include "kr3_executive/abstract_mission.hpp"

#include <exception>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_refinement/low_level_files.hpp>

#include "kr3_executive/domain_files.hpp"
#include "literal_text.hpp"
#include "yaml_reader.hpp"

namespace kr3::executive
{
namespace
{

/// A grid of components for every magnified element, as if a robot had mapped them.
refinement::ComponentMap gridOf(const reasoner::Description& high_level,
                                const reasoner::Description& refinement,
                                const AbstractMissionConfig& config)
{
  std::vector<std::string> wholes;
  for (const auto& magnified : refinement.magnifications)
  {
    const auto* sort = high_level.findSort(magnified.coarse);
    if (sort != nullptr)
      wholes.insert(wholes.end(), sort->elements.begin(), sort->elements.end());
  }
  return refinement::gridMap(wholes, config.components_per_whole, config.pitch_m);
}

/// Passes everything on, and holds what is recorded against the world.
class RecordWitness : public MissionObserver
{
public:
  RecordWitness(MissionObserver& next, const reasoner::Description& high_level,
                const AbstractWorld& world, double threshold)
    : next_(next), high_level_(high_level), world_(world), threshold_(threshold)
  {
  }

  [[nodiscard]] Interest interest() const override { return next_.interest(); }
  void onEvent(const ReportedEvent& event) override { next_.onEvent(event); }
  void onBelief(const ReportedBelief& belief) override { next_.onBelief(belief); }
  void onInput(const Input& input) override { next_.onInput(input); }
  void onDecision(const ReportedDecision& decision) override { next_.onDecision(decision); }
  void onSnapshot(const Snapshot& snapshot) override { next_.onSnapshot(snapshot); }
  void onPolicy(const SolvedPolicy& policy) override { next_.onPolicy(policy); }
  void onRecords(const std::vector<reasoner::Record>& records) override
  {
    for (const auto& record : records)
      count(record);
    next_.onRecords(records);
  }

  RefutationCount refutations;

private:
  void count(const reasoner::Record& record)
  {
    const bool found =
        record.kind == reasoner::RecordKind::kObserved && !record.value && record.source == "robot";
    if (!found || takeApart(record.statement).isBoolean())
      return;
    const bool wrong = world_.holds(reasoner::parseGoal(record.statement, high_level_));
    const bool doubtful = record.confidence <= threshold_;
    refutations.all += 1;
    refutations.wrong += wrong ? 1 : 0;
    refutations.doubtful += doubtful ? 1 : 0;
    refutations.doubtful_wrong += wrong && doubtful ? 1 : 0;
  }

  MissionObserver& next_;
  const reasoner::Description& high_level_;
  const AbstractWorld& world_;
  double threshold_;
};

const reasoner::Literal* firstValued(const reasoner::Formula& goal)
{
  if (goal.kind == reasoner::Formula::Kind::kLiteral)
  {
    const std::string& value = goal.literal.value.name;
    return value == "true" || value == "false" ? nullptr : &goal.literal;
  }
  for (const auto& operand : goal.operands)
  {
    if (const auto* found = firstValued(operand))
      return found;
  }
  return nullptr;
}

}  // namespace

AbstractMissions::AbstractMissions(const std::string& directory, AbstractMissionConfig config)
  : AbstractMissions(read(directory, config), config)
{
}

AbstractMissions::AbstractMissions(std::shared_ptr<Shared> shared, AbstractMissionConfig config)
  : config_(std::move(config))
  , shared_(std::move(shared))
  , policies_(config_.policies)
  , knower_(shared_->domain->highLevel(), config_.plan, shared_->answers)
  , reasoner_(descriptionFor(config_.method, shared_->domain->highLevel()), config_.plan,
              shared_->answers, config_.driver.history_window)
{
}

std::unique_ptr<AbstractMissions> AbstractMissions::another() const
{
  AbstractMissionConfig config = config_;
  config.policies = policies_.cache();
  return std::unique_ptr<AbstractMissions>(new AbstractMissions(shared_, std::move(config)));
}

std::map<std::string, ContentCacheStats> AbstractMissions::cacheStats() const
{
  const ReasonerCache& answers = *shared_->answers;
  const PlanCosts& costs = *shared_->costs;
  return {{"situations", answers.situations.stats()},
          {"named situations", answers.named.stats()},
          {"values", answers.values.stats()},
          {"values at any price", answers.values_at_any_price.stats()},
          {"exceptions", answers.exceptions.stats()},
          {"situation plans", answers.situation_plans.stats()},
          {"plans", answers.plans.stats()},
          {"diagnoses", answers.diagnoses.stats()},
          {"explanations", answers.explanations.stats()},
          {"retractions", answers.retractions.stats()},
          {"entailed", answers.entailed.stats()},
          {"answers", answers.answers.stats()},
          {"plan costs", costs.planStats()},
          {"efforts", costs.effortStats()},
          {"zooms", costs.tasks().zoomStats()},
          {"tasks", costs.tasks().taskStats()}};
}

std::shared_ptr<AbstractMissions::Shared> AbstractMissions::read(
    const std::string& directory, const AbstractMissionConfig& config)
{
  const std::filesystem::path path(directory);
  if (!std::filesystem::is_directory(path))
    throw Unavailable("'" + directory + "' is no directory");
  const auto high_level = reasoner::readDescription((path / "domain.kr3").string());
  const auto refined =
      refinement::readRefinementFile((path / "refinement.kr3").string(), high_level);
  const auto map_file = path / "map.yaml";
  refinement::ModelsOptions numbers;
  numbers.require_learned = config.require_learned;
  const auto file = [&](const std::string& name) {
    const std::string full = (path / name).string();
    return DomainFile{full, readTextFile(full)};
  };
  LoadedDomain loaded =
      load(high_level, refined,
           std::filesystem::exists(map_file) ? refinement::readComponentMap(map_file.string())
                                             : gridOf(high_level, refined, config),
           file(config.models), file(config.bindings), numbers);
  std::optional<refinement::Models> world;
  if (!config.world_models.empty())
  {
    const DomainFile truth = file(config.world_models);
    world = refinement::parseModels(truth.text, truth.name, *loaded.domain);
  }
  Scenario scenario;
  if (std::filesystem::exists(path / "scenario.yaml"))
    scenario = readScenario((path / "scenario.yaml").string(), high_level);
  auto shared = std::make_shared<Shared>(Shared{std::move(loaded.domain), std::move(loaded.models),
                                                std::move(world), std::move(loaded.bindings),
                                                std::move(scenario)});
  shared->costs =
      std::make_shared<PlanCosts>(std::make_shared<TaskCache>(*shared->domain, shared->models));
  return shared;
}

std::string AbstractMissions::targetFluent(const std::string& goal) const
{
  const auto formula = reasoner::parseGoal(goal, shared_->domain->highLevel());
  const auto* literal = firstValued(formula);
  if (literal == nullptr)
    throw InvalidArgument("the goal '" + goal + "' mentions no fluent with values; use --true");
  return reasoner::toString(literal->atom);
}

TrialResult AbstractMissions::run(const std::string& goal, const std::vector<std::string>& truths,
                                  std::uint64_t seed, MissionObserver& observer)
{
  MissionSetup setup{goal, truths, seed, shared_->scenario.initial_records, config_.driver.limits};
  return run(setup, observer);
}

TrialResult AbstractMissions::run(const MissionSetup& setup, MissionObserver& observer,
                                  const ExecutorOf& executor)
{
  const auto formula = reasoner::parseGoal(setup.goal, shared_->domain->highLevel());
  knower_.restart(ConfidenceMatch::kExact);
  knower_.setHistory(setup.initial_records);
  FluentValues coarse;
  FluentValues fine;
  const auto add = [](const std::string& text, FluentValues& values) {
    const LiteralText literal = takeApart(text);
    if (literal.equal)
      values[literal.fluent()] = literal.value;
  };
  for (const auto& literal : knower_.entailedAt(0))
    add(literal, coarse);
  for (const auto& truth : setup.truths)
  {
    if (const auto literal = lowLevelLiteral(truth))
      add(*literal, fine);
    else
      add(reasoner::toString(reasoner::parseGroundLiteral(truth, shared_->domain->highLevel())),
          coarse);
  }

  AbstractWorld world(*shared_->domain, worldModels(), setup.seed);
  world.setNoise(setup.noise);
  world.reset(coarse, fine);
  const Narrator narrator(shared_->bindings.phrases());
  Mission* told = nullptr;
  std::unique_ptr<LowLevelExecutor> between;
  if (executor)
  {
    between = executor(world, [&told](const reasoner::Record& record) {
      // From a thread of its own, as a person tells: the mission's own thread holds its lock.
      std::exception_ptr refused;
      std::thread person([&] {
        try
        {
          told->tell(record);
        }
        catch (const std::exception&)
        {
          refused = std::current_exception();
        }
      });
      person.join();
      if (refused)
        std::rethrow_exception(refused);
    });
  }
  LowLevelExecutor& acting = between ? *between : world;
  reasoner_.restart(observer.interest().narration ? ConfidenceMatch::kExact
                                                  : ConfidenceMatch::kBelowOne);
  RecordWitness witness(observer, shared_->domain->highLevel(), world, setup.limits.threshold);
  const auto mission =
      makeMission(config_.method,
                  {*shared_->domain, shared_->models, narrator, reasoner_, policies_, acting,
                   witness, [&world] { return world.now(); }, config_.driver, shared_->costs},
                  config_.baseline, baseline_cache_);
  told = mission.get();
  TrialResult result;
  result.mission = mission->achieve(setup.goal, setup.initial_records, setup.limits, 0.0);
  result.goal_is_true = world.holds(formula);
  result.history = mission->knowledge().history;
  result.refutations = witness.refutations;
  result.fine = world.fine();
  return result;
}

std::optional<std::string> AbstractMissions::lowLevelLiteral(const std::string& text) const
{
  try
  {
    return reasoner::toString(reasoner::parseGroundLiteral(text, shared_->domain->description()));
  }
  catch (const InvalidArgument&)
  {
    return std::nullopt;
  }
}

}  // namespace kr3::executive
