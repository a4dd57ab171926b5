#include "explain.hpp"

#include <algorithm>
#include <optional>

#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

class Explainer
{
public:
  Explainer(const Description& description, const ReasonerOptions& options,
            const HistoryProgram& program, const std::vector<CheckedRecord>& records,
            int current_step)
    : description_(description)
    , options_(options)
    , program_(program)
    , records_(records)
    , current_step_(current_step)
  {
  }

  /// Whether some records alone entail the literal.
  [[nodiscard]] bool entail(const std::vector<CheckedRecord>& records, const Literal& literal,
                            int step) const
  {
    const auto optimum = findOptimum(program_, records, current_step_, options_.diagnose_exogenous);
    return optimum && Consequences(description_, program_, records, current_step_, *optimum)
                          .inAll(literal, step);
  }

  /// A subset of the records that entails the literal and none of whose records can be left out.
  [[nodiscard]] std::vector<CheckedRecord> support(const Literal& literal, int step) const
  {
    std::vector<CheckedRecord> kept = records_;
    for (bool smaller = true; smaller;)  // entailment is not monotonic: one round may not be enough
    {
      smaller = false;
      for (std::size_t i = kept.size(); i-- > 0;)
      {
        std::vector<CheckedRecord> fewer = kept;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        if (entail(fewer, literal, step))
        {
          kept = std::move(fewer);
          smaller = true;
        }
      }
    }
    return kept;
  }

private:
  const Description& description_;
  const ReasonerOptions& options_;
  const HistoryProgram& program_;
  const std::vector<CheckedRecord>& records_;
  int current_step_;
};

}  // namespace

Explanation explained(const Description& description, const ReasonerOptions& options,
                      const HistoryProgram& program, const std::vector<CheckedRecord>& records,
                      const Optimum& optimum, const Literal& literal, int step)
{
  Explanation explanation;
  explanation.entailed = true;
  int current_step = 0;
  for (const CheckedRecord& checked : records)
  {
    current_step = std::max(current_step, checked.record.step + (checked.isAction() ? 1 : 0));
  }
  const Explainer explainer(description, options, program, records, current_step);
  const std::vector<CheckedRecord> support = explainer.support(literal, step);
  for (const CheckedRecord& checked : support)
  {
    explanation.records.push_back(toString(checked.record));
  }

  // Since when has it held?
  const Consequences consequences(description, program, records, current_step, optimum);
  const std::string text = toString(literal);
  int since = step;
  while (since > 0 && consequences.inAll(literal, since - 1))
  {
    --since;
  }
  if (since < step)
  {
    explanation.reasons.push_back(text + " holds at step " + std::to_string(step) +
                                  " by inertia since step " + std::to_string(since));
  }
  for (const CheckedRecord& checked : support)
  {
    const std::string at = std::to_string(checked.record.step);
    if (!checked.isAction())
    {
      explanation.reasons.push_back(
          "observed at step " + at + ": " + toString(checked.literal) +
          (checked.record.source.empty() ? "" : " (" + checked.record.source + ")"));
    }
    else if (checked.record.step + 1 == since)
    {
      explanation.reasons.push_back(text + " was caused by " + toString(checked.action) +
                                    " at step " + at);
    }
    else
    {
      explanation.reasons.push_back("the action " + toString(checked.action) +
                                    " occurred at step " + at);
    }
  }
  const Instances instances(description);
  const Words words(description, options, instances, support);
  if (const auto small = findOptimum(program, support, current_step, options.diagnose_exogenous))
  {
    const auto explanations = explanationsOf(program, support, current_step, *small);
    if (explanations.size() == 1)
    {
      for (const Clingo::Symbol& assumed : explanations.front())
      {
        explanation.reasons.push_back(words.sentence(assumed) + ", because of what was observed");
      }
    }
    for (const std::string& name :
         firingDefaults(program, support, current_step, *small, literal.atom))
    {
      explanation.reasons.push_back("by default " + name + " about " + toString(literal.atom) +
                                    " initially");
    }
  }
  if (explanation.reasons.empty())
  {
    explanation.reasons.push_back(text + " follows from the description alone");
  }
  return explanation;
}

}  // namespace kr3::reasoner
