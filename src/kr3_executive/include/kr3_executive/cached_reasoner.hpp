#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_reasoner/ground_literals.hpp>
#include <kr3_reasoner/situation.hpp>

#include "kr3_executive/content_cache.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// A situation under names that do not matter, with the key under which it is looked up.
struct KnownSituation
{
  reasoner::RenamedSituation renamed;
  Fingerprint key;
  bool exceptions_only = true;  ///< Situations::Later::exceptions_only of the step to it
};

/// Answers about histories, for reasoners of several threads. Thread-safe.
struct ReasonerCache
{
  ContentCache<bool> histories;  ///< that were taken
  ContentCache<reasoner::PlanResult> plans;
  ContentCache<reasoner::Diagnosis> diagnoses;
  ContentCache<reasoner::Explanation> explanations;
  ContentCache<std::vector<reasoner::Retraction>> retractions;
  ContentCache<std::vector<std::string>> entailed;  ///< at a step
  ContentCache<reasoner::Answer> answers;           ///< whether a literal is entailed, or possible
  // By situation, for all histories that come to it.
  ContentCache<std::optional<KnownSituation>> situations;  ///< the next one
  ContentCache<KnownSituation> named;                      ///< with more records, or for a goal
  ContentCache<std::optional<reasoner::Situations::PossibleValues>> values;
  ContentCache<std::optional<reasoner::Situations::PossibleValues>> values_at_any_price;
  ContentCache<bool> exceptions;  ///< whether they explain it
  ContentCache<reasoner::PlanResult> situation_plans;
};

/// How confidences below 1 count when an answer is looked up.
enum class ConfidenceMatch : std::uint8_t
{
  kExact,
  /// Only whether they are below 1, as long as no record has to be taken to be wrong: then no
  /// model, plan or reason depends on more (the retractions do, which are always looked up
  /// exactly). Where answers quote records in words, the confidences in these words may be those of
  /// another history; Explanation::records are this one's. What the answers about the current step
  /// depend on is the situation there (situation.hpp): they are looked up by that, under names that
  /// do not matter, instead of by the history. Of plans that are equally good another one may be
  /// found then, and they come in the order of their names. Where nothing but a wrong record
  /// explains a history it has no situation, and all is looked up exactly.
  kBelowOne,
};

/// A reasoner that looks into a cache first. Answers are found by the description, the options and
/// the whole history as it was told, call by call, since a long history is progressed in between.
/// What throws, and plans cut off by their time, are not kept.
///
/// An answer must not depend on what was asked before, or missions would not repeat. Which literals
/// are entailed or possible, and what explains a history, is one answer; for these a reasoner is
/// kept from mission to mission, and learns of the history when something has to be computed. Among
/// equally good plans, and equally short reasons, a search picks one by what it learned earlier:
/// these come from a new reasoner each time. From where a history is so long that it is progressed
/// (HistoryWindow), the mission has a reasoner of its own and nothing is looked up by the history:
/// such histories do not repeat, and telling them anew would take longer with each step. Situations
/// are looked up however long the history is.
///
/// Not thread-safe; one instance per thread, which may share the cache.
class CachedReasoner : public HighLevelReasoner
{
public:
  /// @param cache  null: one of its own
  /// @param history_window  steps (history_window.hpp)
  CachedReasoner(reasoner::Description description, const reasoner::PlanOptions& options,
                 std::shared_ptr<ReasonerCache> cache = nullptr,
                 std::uint32_t history_window = kDefaultHistoryWindow);

  /// Back to the empty history, for another mission.
  void restart(ConfidenceMatch match);

  void setHistory(const std::vector<reasoner::Record>& records) override;
  void addRecords(const std::vector<reasoner::Record>& records) override;
  void suppose(const std::vector<reasoner::Record>& records) override;
  reasoner::Diagnosis diagnose() override;
  reasoner::Diagnosis minimalExplanations() override;
  bool isConsistent() override;
  reasoner::Answer entails(const std::string& literal, int step) override;
  bool possible(const std::string& literal, int step) override;
  std::vector<std::string> entailedAt(int step) override;
  reasoner::Explanation explain(const std::string& literal, int step) override;
  bool restsOnDefault(const std::string& literal, int step) override;
  std::vector<reasoner::Retraction> retractions(const std::string& literal, int step) override;
  reasoner::PlanResult plan(const std::string& goal, std::uint32_t max_plans,
                            const std::atomic<bool>& cancel) override;
  std::optional<ReasonerSettings> settings() override { return settings_; }

private:
  /// One call that told records, with what was told up to it.
  struct Told
  {
    enum class How : std::uint8_t
    {
      kAdded,
      kAnew,      ///< in the place of all that was told before
      kSupposed,  ///< the same, by suppose()
    };

    std::vector<reasoner::Record> records;
    How how = How::kAdded;
    Fingerprint exact;
    Fingerprint below_one;

    void tell(InProcessReasoner& reasoner) const;
  };

  /// What there is to know of a call that reached the reasoner.
  struct Applied
  {
    Told::How how;
    Fingerprint exact;

    [[nodiscard]] bool is(const Told& told) const { return how == told.how && exact == told.exact; }
  };

  /// What the history says about the current step, by the names of `situation`.
  struct Present
  {
    std::shared_ptr<const KnownSituation> situation;
    reasoner::Renaming renaming;  ///< from the history's names
    int step = 0;
    bool exceptions_only = true;  ///< nothing else was assumed before this step
    /// By the situation's names, and by the history's; found when they are first needed.
    std::shared_ptr<const reasoner::Situations::PossibleValues> values_there = {};
    std::optional<reasoner::Situations::PossibleValues> values = {};
  };

  /// @throws InvalidArgument  a record does not fit the description; nothing was told then
  void tell(const std::vector<reasoner::Record>& records, Told::How how);
  void tellWhole(const Fingerprint& key);
  /// Follows the situation as far as it can be.
  void follow(const std::vector<reasoner::Record>& records, bool anew);
  [[nodiscard]] bool advance(Present& present, const std::vector<reasoner::Record>& records);
  [[nodiscard]] KnownSituation known(reasoner::RenamedSituation renamed) const;
  /// The situation with more records of its step, by its own names.
  [[nodiscard]] std::shared_ptr<const KnownSituation> withRecords(
      const KnownSituation& situation, const std::vector<reasoner::Record>& records);
  /// The situation under names that do not matter to it and to a goal.
  [[nodiscard]] std::shared_ptr<const KnownSituation> forGoal(const KnownSituation& situation,
                                                              const std::string& goal);
  static void become(Present& present, std::shared_ptr<const KnownSituation> other);
  /// Of the current step, by the situation's names; nullptr when it is not followed.
  [[nodiscard]] const reasoner::Situations::PossibleValues* valuesThere();
  using KnownValues = std::shared_ptr<const std::optional<reasoner::Situations::PossibleValues>>;
  enum class Price
  {
    kLeast,
    kAny,
  };
  /// The values in models at this price, from the cache.
  [[nodiscard]] KnownValues valuesOf(const KnownSituation& situation, Price price);
  /// The values at a step, when the situation is followed and that is the current step.
  [[nodiscard]] const reasoner::Situations::PossibleValues* valuesAt(int step);
  [[nodiscard]] std::optional<reasoner::Answer> answerAt(const std::string& literal, int step);
  /// Whether the situation is followed, and all that is assumed is exceptions to defaults.
  [[nodiscard]] bool assumesExceptionsOnly();
  /// retractions() for a literal that is false at the current step: what contradicts it there, when
  /// giving that up is all that it takes. Nothing where the situation does not tell.
  [[nodiscard]] std::optional<std::vector<reasoner::Retraction>> situationRetractions(
      const std::string& literal);
  [[nodiscard]] std::shared_ptr<const KnownSituation> withoutContrary(
      const KnownSituation& situation, const reasoner::Literal& there);
  [[nodiscard]] std::optional<reasoner::PlanResult> situationPlan(const std::string& goal,
                                                                  std::uint32_t max_plans,
                                                                  const std::atomic<bool>& cancel);
  /// The mission gets a reasoner of its own when the history is long.
  void becomeLongIfDue();
  [[nodiscard]] bool isLong() const;
  /// The reasoner that is kept, with the whole history.
  InProcessReasoner& current();
  /// A new one with the whole history, or the mission's own.
  [[nodiscard]] std::shared_ptr<InProcessReasoner> unbiased();
  [[nodiscard]] std::shared_ptr<InProcessReasoner> fresh() const;
  /// @throws InvalidArgument  a record does not fit the description
  void becomeLong();
  /// What the cache knows, else what is computed and, if it may be, kept.
  template <typename Value, typename Compute, typename SizeOf>
  Value answer(ContentCache<Value>& cache, const Fingerprint& key, const Compute& compute,
               const SizeOf& size_of);
  [[nodiscard]] Fingerprint keyOf(const char* question, const std::string& text, int step,
                                  bool exactly) const;
  [[nodiscard]] std::vector<reasoner::Record> records() const;
  /// The records that an explanation cites, by their texts in this history; false when they are
  /// counted otherwise, as after progression.
  [[nodiscard]] bool cite(reasoner::Explanation& explanation) const;

  std::shared_ptr<ReasonerCache> cache_;
  reasoner::Description description_;
  reasoner::GroundLiterals literals_;
  reasoner::PlanOptions options_;
  ReasonerSettings settings_;
  std::shared_ptr<InProcessReasoner> reasoner_;
  ConfidenceMatch match_ = ConfidenceMatch::kExact;
  Fingerprint empty_;  // of the description and the options
  std::vector<Told> told_;
  int step_ = 0;                                      // current one of what was told
  bool is_long_ = false;                              // the reasoner is this mission's own
  std::vector<Applied> applied_;                      // the calls that reached the reasoner
  std::unique_ptr<reasoner::Situations> situations_;  // made when it is first needed
  std::optional<Present> present_;                    // while the situation is followed
};

}  // namespace kr3::executive
