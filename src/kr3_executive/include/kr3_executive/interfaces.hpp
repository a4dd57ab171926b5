#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/model.hpp>
#include <kr3_pomdp/policy.hpp>
#include <kr3_reasoner/reasoner.hpp>

/// What the executive needs from others. Each interface has an implementation in process
/// (in_process.hpp, abstract_world.hpp) and one that talks to nodes (ros/clients.hpp).
namespace kr3::executive
{

/// The current step of a history: the largest step among its records, or one more when an action is
/// recorded there; 0 for an empty one.
[[nodiscard]] int currentStep(const std::vector<reasoner::Record>& history);

/// Steps of a history that are kept one by one where nothing else is asked for.
inline constexpr std::uint32_t kDefaultHistoryWindow = 60;

/// What the answers of a reasoner depend on besides the description and the history.
struct ReasonerSettings
{
  reasoner::ReasonerOptions options;  ///< of its diagnoses; `window` and `least_step` are 0
  std::uint32_t history_window = kDefaultHistoryWindow;  ///< history_window.hpp; 0: all
};

/// The high level. A question about an inconsistent history throws FailedPrecondition.
class HighLevelReasoner
{
public:
  virtual ~HighLevelReasoner() = default;

  /// All records are taken or none. @throws InvalidArgument  a record does not fit the description
  virtual void setHistory(const std::vector<reasoner::Record>& records) = 0;
  virtual void addRecords(const std::vector<reasoner::Record>& records) = 0;
  /// As setHistory(), for a question or two about what would be: however long the history is, it is
  /// not progressed, which would take longer than they do.
  virtual void suppose(const std::vector<reasoner::Record>& records) = 0;

  [[nodiscard]] virtual reasoner::Diagnosis diagnose() = 0;
  /// The same without reasons and words: consistency and minimal explanations.
  [[nodiscard]] virtual reasoner::Diagnosis minimalExplanations() { return diagnose(); }
  /// Diagnosis::consistent alone.
  [[nodiscard]] virtual bool isConsistent() { return minimalExplanations().consistent; }
  [[nodiscard]] virtual reasoner::Answer entails(const std::string& literal, int step) = 0;
  [[nodiscard]] virtual bool possible(const std::string& literal, int step) = 0;
  /// Entailed literals in the language, such as "loc(rob1) = office".
  [[nodiscard]] virtual std::vector<std::string> entailedAt(int step) = 0;
  [[nodiscard]] virtual reasoner::Explanation explain(const std::string& literal, int step) = 0;
  /// Whether an entailed literal rests on a default: explain() would cite one, as long as it cites
  /// what happened before the window of a history that is progressed.
  [[nodiscard]] virtual bool restsOnDefault(const std::string& literal, int step)
  {
    return !explain(literal, step).defaults.empty();
  }
  /// Doubtful records to give up, most doubtful first: so that the literal is possible, or with an
  /// empty one so that the history is consistent. None when it is, or when no doubtful record
  /// helps.
  [[nodiscard]] virtual std::vector<reasoner::Retraction> retractions(const std::string& literal,
                                                                      int step) = 0;
  /// @param max_plans  for each hypothesis: 1, or so many of those that are equally short
  /// @param cancel     may be set from another thread; the call then throws Cancelled
  [[nodiscard]] virtual reasoner::PlanResult plan(const std::string& goal, std::uint32_t max_plans,
                                                  const std::atomic<bool>& cancel) = 0;
  /// Nothing when it cannot be told.
  [[nodiscard]] virtual std::optional<ReasonerSettings> settings() = 0;
};

/// When the solver may stop; whichever comes first. Precision and counted work decide, so that a
/// solve repeats; wall time is for emergencies. With the defaults a search of 4 cells ends by
/// its precision in about 0.15 s of CPU, one of 9 cells after 0.7 s and one of 16 after 2 s by the
/// counted work, 0.4 % and about 1 s of reward below what twice the work finds
/// (docs/coupling.md).
struct SolveBudget
{
  double precision = 0.5;
  double time_s = 30.0;               ///< wall time; 0 = no limit
  std::uint64_t max_backups = 20000;  ///< counted work; 0 = no limit
};

struct SolvedPolicy
{
  std::string id;
  double lower = 0.0;
  double upper = 0.0;
  std::uint64_t backups = 0;
  double cpu_s = 0.0;
  bool cached = false;

  /// Whether neither precision nor counted work ended the solve, but wall time or memory: then it
  /// need not repeat.
  [[nodiscard]] bool isCutShort(const SolveBudget& budget) const;
};

/// Solves models and answers for their policies.
class PolicyServer
{
public:
  virtual ~PolicyServer() = default;

  [[nodiscard]] virtual SolvedPolicy solve(const pomdp::Model& model, const SolveBudget& budget,
                                           const std::atomic<bool>& cancel) = 0;
  /// The same from a policy of the model that is known (pomdp::solve() says what it must be); a
  /// server that has no use for it solves without.
  [[nodiscard]] virtual SolvedPolicy solveFrom(const pomdp::Policy& /*first*/,
                                               const pomdp::Model& model, const SolveBudget& budget,
                                               const std::atomic<bool>& cancel)
  {
    return solve(model, budget, cancel);
  }
  /// Index of the action at the belief. @throws NotFound  no such policy (any more)
  [[nodiscard]] virtual std::size_t actionAt(const std::string& policy_id,
                                             const pomdp::Belief& belief) = 0;
};

/// A ground low-level action with what its observation laws tell about.
struct LowLevelAction
{
  std::string text;    ///< "search(rob1, c1, tb1)"
  std::string symbol;  ///< "search"
  std::vector<std::string> arguments;
};

/// The value of a ground fluent where the robot believes it to be, for bindings such as
/// `${loc(R)}`; empty when it is not known.
using FluentLookup = std::function<std::string(const std::string& fluent)>;

/// A fact that a skill noticed without being asked about it.
struct Sighting
{
  std::string literal;      ///< of the low level, ground: "loc(tb1) = c7"
  double confidence = 1.0;  ///< probability that it is right, (0, 1]
};

struct LowLevelResult
{
  std::string outcome;                   ///< label, for people
  std::vector<std::string> observation;  ///< one value for each observation law of the action, in
                                         ///< the order of the description; a value's name, "true"
                                         ///< or "false"
  double confidence = 1.0;               ///< of the observation, (0, 1]
  double duration_s = 0.0;
  std::vector<Sighting> sightings;  ///< noticed by the way
};

/// Executes ground low-level actions on a robot, real or simulated.
class LowLevelExecutor
{
public:
  virtual ~LowLevelExecutor() = default;

  /// @param cancel  may be set from another thread: the action ends early and safely, and what was
  ///                observed is returned or Cancelled is thrown
  /// @throws Unavailable, DeadlineExceeded  the action could not be executed
  [[nodiscard]] virtual LowLevelResult execute(const LowLevelAction& action,
                                               const FluentLookup& believed,
                                               const std::atomic<bool>& cancel) = 0;
};

}  // namespace kr3::executive
