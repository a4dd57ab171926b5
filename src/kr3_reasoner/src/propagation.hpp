#pragma once

#include <cstddef>
#include <vector>

#include "search_limit.hpp"

namespace kr3::reasoner
{

/// `variable = value` or `variable != value`; values count from 0.
struct FiniteLiteral
{
  int variable = -1;
  int value = 0;
  bool equal = true;
  int step = 0;  ///< of the history, where the literal is said; for people only
};

/// One inference: what was concluded, by which clause, from what.
struct Inference
{
  /// Origins below 0 are no clauses.
  enum : int
  {
    kImplied = -1,        ///< `x != w` from `x = v`
    kOnlyValue = -2,      ///< every other value is excluded
    kSupposed = -3,       ///< for a contradiction
    kClash = -4,          ///< a contradiction: its antecedents cannot both be
    kContradiction = -5,  ///< the contrary leads to the antecedent, a contradiction
    kCases = -6,          ///< a contradiction in each of two cases, the antecedents
  };

  FiniteLiteral literal;  ///< variable -1 for a contradiction
  int origin = kSupposed;
  std::vector<int> antecedents;  ///< inferences
  std::vector<int> used_at;      ///< the step at which each antecedent is used
};

/// Unit propagation over variables with finite domains, which remembers every inference, and
/// refutation by cases where propagation is not enough. Sound: what it concludes follows from the
/// clauses. Private to the package; knows nothing of actions and histories.
class Propagation
{
public:
  /// @param limit  of all searching; must outlive this object
  explicit Propagation(const SearchLimit& limit) : limit_(limit) {}

  /// @param size  of the domain, at least 1
  int addVariable(int size);

  /// A disjunction. `origin` (0 or more) is the caller's; it is repeated in inferences.
  void addClause(const std::vector<FiniteLiteral>& literals, int origin);

  /// `head = 1` holds only if it follows from these rules (least model, as of a definition); the
  /// head and the bodies' variables are booleans, 0 and 1, or others.
  void addFoundedRule(FiniteLiteral head, std::vector<FiniteLiteral> body, int origin);

  /// A conclusion made elsewhere. Returns its number.
  int addInference(Inference inference);

  /// Takes a conclusion made elsewhere for true, unless it is known already.
  void assume(int inference);

  /// Draws conclusions. Returns the inference of a contradiction, or -1.
  int propagate();

  /// The inference of a literal that is known, or -1.
  [[nodiscard]] int find(const FiniteLiteral& literal) const;

  /// The inference of a literal, proved by contradiction and by cases if need be; -1 when none is
  /// found. @param max_cases  bound on the number of distinctions
  int prove(const FiniteLiteral& literal, int max_cases);

  /// The inference of a contradiction, or -1.
  int refute(int max_cases);

  /// For a return to what is known now. What was not propagated before counts as not known.
  [[nodiscard]] std::size_t mark() const { return trail_.size(); }
  void returnTo(std::size_t mark) { undo(mark); }

  [[nodiscard]] const Inference& inference(int number) const
  {
    return inferences_[static_cast<std::size_t>(number)];
  }

private:
  struct ClauseLiteral
  {
    FiniteLiteral literal;
    std::size_t place = 0;    ///< its index
    std::size_t negated = 0;  ///< of its negation
  };
  struct Clause
  {
    std::vector<ClauseLiteral> literals;
    int origin = 0;
    std::size_t num_false = 0;  ///< of its literals, as far as the trail is processed
    std::size_t num_true = 0;   ///< likewise
  };
  struct FoundedRule
  {
    FiniteLiteral head;
    std::vector<FiniteLiteral> body;
    int origin = 0;
  };

  [[nodiscard]] FiniteLiteral canonical(FiniteLiteral literal) const;
  [[nodiscard]] FiniteLiteral negated(FiniteLiteral literal) const;
  [[nodiscard]] std::size_t index(const FiniteLiteral& literal) const;
  [[nodiscard]] bool isProcessed(std::size_t place) const;
  void conclude(const FiniteLiteral& literal, int origin, std::vector<int> antecedents,
                std::vector<int> used_at);
  void know(const FiniteLiteral& literal, int inference);
  void process(const FiniteLiteral& literal);
  void concludeFrom(const Clause& clause);
  bool concludeUnfounded();
  void undo(std::size_t mark);
  int suppose(const FiniteLiteral& literal, int& max_cases);
  int refuteByCases(int& max_cases);
  [[nodiscard]] const FiniteLiteral* distinction() const;

  const SearchLimit& limit_;
  std::vector<int> sizes_;
  std::vector<std::size_t> offsets_;
  std::size_t num_literals_ = 0;
  std::vector<int> known_;                           // inference of each literal, or -1
  std::vector<std::size_t> trail_place_;             // of each literal that is known
  std::vector<std::vector<std::size_t>> falsifies_;  // clauses with the literal's negation
  std::vector<std::vector<std::size_t>> satisfies_;  // clauses with the literal
  std::vector<int> num_excluded_;                    // values of each variable
  std::vector<Clause> clauses_;
  std::vector<FoundedRule> founded_;
  std::vector<FiniteLiteral> trail_;
  std::size_t num_processed_ = 0;
  std::vector<Inference> inferences_;
  int contradiction_ = -1;
};

}  // namespace kr3::reasoner
