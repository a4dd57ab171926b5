#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

enum class RecordKind : std::uint8_t
{
  kObserved = 0,   ///< obs(literal, value, step)
  kHappened = 1,   ///< hpd(action, step)
  kAttempted = 2,  ///< attempt(action, step)
  kInitially = 3,  ///< init(literal, value), the same as kObserved at step 0
};

/// One record of a history (Zhang et al. 2014, "Histories with defaults"). The values of `kind`
/// equal the constants of kr3_msgs/HistoryRecord.
struct Record
{
  RecordKind kind = RecordKind::kObserved;
  std::string statement;  ///< ground literal or ground action, in the language
  bool value = true;
  int step = 0;
  double confidence = 1.0;  ///< probability that the record is right, (0, 1]
  std::string source = "robot";
};

/// `obs(loc(tb1) = office, true, 3)` and so on.
[[nodiscard]] std::string toString(const Record& record);

/// Parses a history file: one record a statement, `obs(l, bool, step).`, `hpd(a, step).`,
/// `attempt(a, step).`, `init(l, bool).`, checked against the description.
[[nodiscard]] std::vector<Record> parseHistory(const std::string& text, const std::string& file,
                                               const Description& description);

enum class Answer : std::uint8_t
{
  kFalse = 0,
  kTrue = 1,
  kUnknown = 2
};

/// Minimal explanations of the history (paper, Definition 2).
struct Diagnosis
{
  bool consistent = false;
  int cost = 0;  ///< minimal |E|
  std::vector<std::vector<std::string>>
      explanations;  ///< each a minimal E: statements such as "init(loc(tb1) = main_library,
                     ///< false)" or "exo_move(tb1, office) at 2"
  std::vector<std::string>
      in_words;  ///< each explanation for people, naming the default that is excepted
  std::vector<std::string> conflict;  ///< when inconsistent: a minimal set of conflicting records
};

/// A shortest plan under a hypothesis: values, at the current step, of fluents that the history
/// leaves open and on which the plan depends.
struct Plan
{
  std::vector<std::string> hypothesis;  ///< literals, empty when nothing is assumed
  std::vector<std::vector<std::string>>
      steps;  ///< ground actions that occur together, one entry a step
};

struct PlanOptions
{
  int max_horizon = 12;
  std::chrono::milliseconds time_limit{10000};
  std::function<void(int)> on_horizon;  ///< called with each horizon before it is tried, if set
};

struct PlanResult
{
  bool goal_entailed = false;  ///< nothing to do
  std::vector<Plan> plans;     ///< one a hypothesis; empty when there is none
  std::string reason;          ///< when there is no plan: why
  double cpu_s = 0.0;
};

/// Why a literal is entailed (DESIGN.md 3.2 point 10).
struct Explanation
{
  bool entailed = false;
  std::vector<std::string> reasons;  ///< in words, from the literal itself down to what it rests on
  std::vector<std::string> records;  ///< the records it rests on
};

/// What a diagnosis may assume, and at what price.
struct ReasonerOptions
{
  /// Whether exogenous actions ("somebody moved it") compete with exceptions to defaults from the
  /// start. When false, they are assumed only if no exception explains the history.
  bool diagnose_exogenous = false;
  int exception_weight = 1;  ///< price of one exception to a default, at least 1
  int exogenous_weight =
      1;  ///< price of one exogenous action, and of one failed attempt, at least 1
  std::map<std::string, int>
      default_weights;  ///< price of an exception to the named default, where it differs
};

/// The high-level reasoner: a description, a growing history, and questions about them, answered by
/// clingo.
///
/// The current step is the largest step among the records, or one more when an action is recorded
/// there. Not thread-safe; one instance per thread. A question that fails leaves the history as it
/// was.
class Reasoner
{
public:
  explicit Reasoner(Description description, ReasonerOptions options = {});
  ~Reasoner();
  Reasoner(Reasoner&&) noexcept;
  Reasoner& operator=(Reasoner&&) noexcept;
  Reasoner(const Reasoner&) = delete;
  Reasoner& operator=(const Reasoner&) = delete;

  [[nodiscard]] const Description& description() const;
  [[nodiscard]] const std::vector<Record>& history() const;
  [[nodiscard]] int currentStep() const;

  /// Replaces or extends the history; all records are taken or none.
  /// @throws InvalidArgument  a record does not fit the description
  void setHistory(std::vector<Record> records);
  void addRecords(const std::vector<Record>& records);

  /// Paper, Definitions 2 and 3. @throws FailedPrecondition  the history is inconsistent
  /// (entailment only)
  [[nodiscard]] Diagnosis diagnose() const;
  [[nodiscard]] Answer entails(const std::string& literal, int step) const;
  [[nodiscard]] bool possible(const std::string& literal, int step) const;

  /// All literals `f = v` (and `f != v` where no value of f is entailed) that are entailed at a
  /// step.
  [[nodiscard]] std::vector<Literal> entailedAt(int step) const;

  /// The values that a ground fluent takes at a step in some model, in the order of its sort.
  [[nodiscard]] std::vector<std::string> possibleValues(const std::string& fluent, int step) const;

  [[nodiscard]] Explanation explain(const std::string& literal, int step) const;

  /// Shortest plans from the current step, one per hypothesis (DESIGN.md 3.2 point 8).
  /// @param cancel  may be set from another thread; the call then throws Cancelled
  [[nodiscard]] PlanResult plan(const std::string& goal, const PlanOptions& options = {},
                                const std::atomic<bool>* cancel = nullptr) const;

  /// The ASP program that `entails`, `diagnose` and `plan` solve, with comments that point to
  /// source lines.
  [[nodiscard]] std::string translation() const;

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::reasoner
