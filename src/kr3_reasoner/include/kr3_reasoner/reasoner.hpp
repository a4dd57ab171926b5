#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kr3_reasoner/explanation.hpp"
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
  SourcePosition position = {};  ///< where it stands in a history file; line 0: in none
};

/// `obs(loc(tb1) = office, true, 3)` and so on.
[[nodiscard]] std::string toString(const Record& record);

/// Parses a history file: one record a statement, `obs(l, bool, step).`, `hpd(a, step).`,
/// `attempt(a, step).`, `init(l, bool).`, checked against the description.
[[nodiscard]] std::vector<Record> parseHistory(const std::string& text, const std::string& file,
                                               const Description& description);

/// Reads and parses a history file. @throws NotFound  no such file; InvalidArgument as parseHistory
[[nodiscard]] std::vector<Record> readHistory(const std::string& path,
                                              const Description& description);

enum class Answer : std::uint8_t
{
  kFalse = 0,
  kTrue = 1,
  kUnknown = 2
};

/// What explains a part of what is unexpected, such as that of one thing: any of these goes with
/// any of those of the other parts.
struct ExplanationPart
{
  int price = 0;
  std::vector<std::vector<std::string>> explanations;  ///< as in Diagnosis, at most 200
  std::vector<std::string> in_words;                   ///< each for people
  bool complete = true;                                ///< there are no others
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
  std::vector<ExplanationAlternative> alternatives;  ///< the same, with prices and reasons
  bool complete = true;  ///< `explanations` has all of them, not the first 200 of more
  std::vector<ExplanationPart> parts;  ///< of which `explanations` are put together
  std::vector<std::string> conflict;   ///< when inconsistent: a minimal set of conflicting records
  std::vector<std::size_t> conflict_records;  ///< the same, as indices into the history
  std::string conflict_in_words;              ///< with files and lines where records have them
};

/// A plan under a hypothesis: values, at the current step, of fluents that the history leaves open
/// and on which the plan depends. In every model with a minimal explanation that agrees with the
/// hypothesis each step can be executed and the goal is reached.
struct Plan
{
  std::vector<std::string> hypothesis;  ///< literals, empty when nothing is assumed
  std::vector<std::vector<std::string>>
      steps;          ///< ground actions that occur together, sorted, one entry a step
  double cost = 0.0;  ///< sum over its actions of their costs (1 where the description names none);
                      ///< where a cost depends on the state, the largest under the hypothesis
};

/// Which plans are wanted, for each hypothesis.
enum class PlanPreference : std::uint8_t
{
  kShortest = 0,          ///< fewest steps, then fewest actions
  kCheapestShortest = 1,  ///< fewest steps, then the least cost, then fewest actions
  kCheapest = 2,  ///< the least cost up to the longest horizon, then fewest steps and actions
};

struct PlanOptions
{
  int max_horizon = 12;  ///< longest plan that is tried, in steps, at least 1
  std::chrono::milliseconds time_limit{10000};  ///< wall time
  std::function<void(int)> on_horizon;  ///< called with each horizon before it is tried, if set
  PlanPreference preference = PlanPreference::kShortest;
  bool all = false;     ///< all the plans that are equally good, for each hypothesis
  int max_plans = 100;  ///< with `all`: at most so many for a hypothesis, at least 1

  /// Plan on the part of the description and the history that can matter to the goal. The answer is
  /// the same; without it all of the description is used.
  bool relevant_only = true;
  double extra_share = 0.0;  ///< this share of the constants that do not matter is kept all the
                             ///< same, in [0, 1] (for experiments)
};

/// The size of a description with its history.
struct ProblemSize
{
  std::size_t fluents = 0;    ///< ground, statics left out
  std::size_t constants = 0;  ///< elements of sorts
  std::size_t actions = 0;    ///< ground, exogenous ones left out
  std::size_t records = 0;
};

struct PlanResult
{
  bool goal_entailed = false;  ///< nothing to do
  std::vector<Plan> plans;     ///< one a hypothesis (more with PlanOptions::all, then those of one
                               ///< hypothesis follow each other, sorted); empty when there is none
  bool complete = true;    ///< false when PlanOptions::max_plans or the time limit left plans out
  bool covers_all = true;  ///< false when some possible state has no plan within the horizon
  std::string reason;      ///< when there is no plan: why; or why the plans are not complete
  double cpu_s = 0.0;
  ProblemSize considered;  ///< what was planned with
  ProblemSize whole;       ///< of how much
  int widened = 0;         ///< how often the relevant part was too small and was computed anew
};

/// A constant, fluent or action that can matter to a goal, and why.
struct RelevantItem
{
  std::string name;
  std::vector<std::string> why;  ///< from the goal to the item, a sentence a step
};

/// The part of a description and its history that can matter to a goal.
struct RelevantPart
{
  std::vector<RelevantItem> constants;
  std::vector<RelevantItem> fluents;  ///< ground; a plan depends on no others
  std::vector<RelevantItem> actions;  ///< ground; an argument that may be anything relevant is `_`
  std::vector<Record> records;        ///< about relevant fluents and actions
  ProblemSize considered;
  ProblemSize whole;
};

/// One model of a history (paper, Definition 2): a path of states with a minimal explanation.
struct HistoryModel
{
  std::vector<std::string> assumed;          ///< as in Diagnosis::explanations
  std::vector<std::vector<Literal>> states;  ///< at each step from Reasoner::firstStep() on `f = v`
                                             ///< for every fluent, in the order of declaration
  std::vector<std::vector<std::string>> actions =
      {};              ///< what occurs at each step but the last, exogenous actions included
  int first_step = 0;  ///< of states and actions
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
  int least_step = 0;   ///< the current step is at least this, even if no record is about it

  /// If above 0, addRecords() progresses the history by itself, so that at most half as many steps
  /// again are kept. Records about earlier steps are then refused.
  int window = 0;
  /// Progressing keeps at most so many combinations of values that hang together, and of each so
  /// many equally good explanations; both at least 1.
  int max_combinations = 1000;
  int max_carried_explanations = 16;
};

/// What became of a wish to progress a history.
struct Progress
{
  int first_step = 0;                     ///< where the history begins now
  std::size_t num_records = 0;            ///< that are left
  std::vector<std::string> kept_because;  ///< what could not be represented at the step that was
                                          ///< wished for, in words; empty when it begins there
};

/// When a question has to end. What ends that way throws Cancelled or DeadlineExceeded, grounding
/// included, and leaves the reasoner as it was.
struct Limits
{
  std::chrono::milliseconds time_limit{0};    ///< wall time of each question; 0: none
  const std::atomic<bool>* cancel = nullptr;  ///< may be set from another thread; must live as long
                                              ///< as it is the reasoner's limit
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

  /// Where the history begins: 0, or the step to which it was progressed. Steps keep their numbers.
  [[nodiscard]] int firstStep() const;

  /// Lets the history begin at a later step: the records before it are no longer kept, but what
  /// they say about the step is. That is, for every combination of values that fluents which hang
  /// together may have, what has to be assumed for it at the least, so that later records may still
  /// refute today's minimal explanation. All answers about the step and later ones stay the same,
  /// whatever is recorded from then on (docs/semantics_tests.md, row 11).
  ///
  /// Where there are more combinations than ReasonerOptions::max_combinations, the history begins
  /// at the latest step before at which there are not, or where it began.
  ///
  /// @param step  from firstStep() to currentStep()
  /// @throws InvalidArgument  the step is out of range; FailedPrecondition  the history is
  ///         inconsistent
  Progress progress(int step);

  /// Replaces or extends the history; all records are taken or none. A history that is replaced
  /// begins at step 0 again.
  /// @throws InvalidArgument  a record does not fit the description, or is about a step before
  ///         firstStep()
  void setHistory(std::vector<Record> records);
  void addRecords(const std::vector<Record>& records);

  /// Takes over the history of another reasoner for the same description, from where it begins.
  /// Nothing is shared that would keep the two from being used in different threads afterwards.
  /// @throws FailedPrecondition  the history was progressed with other prices of assumptions
  void follow(const Reasoner& other);

  /// For all questions that follow, until other limits are set; reasoners that this one supposes
  /// have the same. A question is over within about 20 ms of its limit. PlanOptions and the flag
  /// that plan() is given hold besides; that flag takes the place of this one.
  /// @throws InvalidArgument  a negative time limit
  void setLimits(const Limits& limits);

  /// Paper, Definitions 2 and 3. @throws FailedPrecondition  the history is inconsistent
  /// (entailment only)
  [[nodiscard]] Diagnosis diagnose() const;
  /// The same without reasons, words and conflicts: consistency, cost and explanations.
  [[nodiscard]] Diagnosis minimalExplanations() const;
  [[nodiscard]] bool isConsistent() const;
  [[nodiscard]] Answer entails(const std::string& literal, int step) const;
  [[nodiscard]] bool possible(const std::string& literal, int step) const;

  /// The models of the history, each once. @param limit  the largest number of models, 0 for all
  /// @throws FailedPrecondition  the history is inconsistent
  [[nodiscard]] std::vector<HistoryModel> models(std::size_t limit = 1000) const;

  /// All literals `f = v` (and `f != v` where no value of f is entailed) that are entailed at a
  /// step.
  [[nodiscard]] std::vector<Literal> entailedAt(int step) const;

  /// The values that a ground fluent takes at a step in some model, in the order of its sort.
  [[nodiscard]] std::vector<std::string> possibleValues(const std::string& fluent, int step) const;

  [[nodiscard]] Explanation explain(const std::string& literal, int step) const;

  /// Why a literal is not known: which values its fluent may have, which default could say more and
  /// why it does not, and whether observing the fluent now would settle it.
  [[nodiscard]] OpenQuestion whyUnknown(const std::string& literal, int step) const;

  /// What if these records were in the history as well? The reasoner that answers has the same
  /// description and options; this one does not change. Both share what was made of the
  /// description, so that together they are as little thread-safe as one alone.
  /// @throws InvalidArgument  a record does not fit the description
  [[nodiscard]] Reasoner supposing(const std::vector<Record>& hypothetical) const;

  /// Which doubtful records (confidence below 1) would have to be given up so that the history is
  /// consistent; most doubtful first, at most eight sets. Empty when it is consistent as it is, or
  /// when no doubtful record helps.
  [[nodiscard]] std::vector<Retraction> retractions() const;

  /// The same, so that a literal is possible at a step. Empty when it is possible already, when no
  /// record refutes it (it is only less plausible), or when no doubtful record helps.
  [[nodiscard]] std::vector<Retraction> retractionsFor(const std::string& literal, int step) const;

  /// The least certain refutation of a value of a ground fluent at the current step: what to give
  /// up when every value that was hoped for is refuted (docs/semantics_tests.md, row 6). `opens`
  /// names a value that becomes possible. No records when no doubtful record refutes a value. How
  /// often to ask is the caller's business.
  [[nodiscard]] Retraction leastCertainRefutation(const std::string& fluent) const;

  /// Plans from the current step, for each hypothesis (docs/semantics_tests.md, row 8).
  /// @param cancel  may be set from another thread; the call then throws Cancelled
  /// @throws InvalidArgument  the goal does not fit the description, or an option is out of range;
  ///                          DeadlineExceeded  the time limit passed; Cancelled
  [[nodiscard]] PlanResult plan(const std::string& goal, const PlanOptions& options = {},
                                const std::atomic<bool>* cancel = nullptr) const;

  /// What can matter to a goal, and why.
  [[nodiscard]] RelevantPart relevant(const std::string& goal) const;

  /// The answer set program of the description and the history, complete as it stands: plain
  /// `clingo FILE 0` lists exactly the models of the history. Comments point to source lines.
  /// @throws FailedPrecondition  the history is inconsistent
  [[nodiscard]] std::string translation() const;

  /// The same with a goal: `clingo FILE 0` lists the trajectories in which a plan of the given
  /// length reaches the goal in at least one model of the history.
  /// @param length  steps of the plan, at least 0
  [[nodiscard]] std::string translation(const std::string& goal, int length) const;

private:
  class Impl;
  explicit Reasoner(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::reasoner
