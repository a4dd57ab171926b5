#include <algorithm>
#include <utility>

#include "explain.hpp"
#include "minimal_explanations.hpp"
#include "reasoner_impl.hpp"

namespace kr3::reasoner
{

namespace
{

/// What an explanation assumes, without what called for it.
ExplanationAlternative inWords(const std::vector<Clingo::Symbol>& explanation, int price,
                               const Words& words)
{
  ExplanationAlternative said;
  said.price = price;
  for (const Clingo::Symbol& assumed : explanation)
  {
    said.assumptions.push_back(words.assumption(assumed));
    said.in_words += (said.in_words.empty() ? "" : "; ") + said.assumptions.back().sentence;
  }
  return said;
}

std::vector<std::string> statementsOf(const ExplanationAlternative& alternative)
{
  std::vector<std::string> statements;
  for (const Assumption& assumption : alternative.assumptions)
  {
    statements.push_back(assumption.statement);
  }
  return statements;
}

ExplanationPart inWords(const PartExplanations& part, const Words& words)
{
  ExplanationPart said;
  said.price = part.price.sum();
  said.complete = part.complete;
  for (const auto& explanation : part.alternatives)
  {
    ExplanationAlternative alternative = inWords(explanation, said.price, words);
    said.explanations.push_back(statementsOf(alternative));
    said.in_words.push_back(std::move(alternative.in_words));
  }
  return said;
}

}  // namespace

Diagnosis Reasoner::diagnose() const
{
  const auto asked = impl_->ask("diagnosis");
  constexpr std::size_t kMaxJustifiedAlternatives = 8;  // a proof each: people read no more
  Diagnosis diagnosis;
  const std::optional<Optimum>& optimum = impl_->optimum();
  diagnosis.consistent = optimum.has_value();
  const int first = impl_->program().firstStep();
  if (!optimum)
  {
    diagnosis.conflict_records =
        minimalConflict(impl_->program(), impl_->records(), impl_->currentStep());
    for (const std::size_t i : diagnosis.conflict_records)
    {
      diagnosis.conflict.push_back(toString(impl_->history()[i]));
    }
    diagnosis.conflict_in_words =
        "these records cannot all be right" +
        (first == 0 ? std::string()
                    : ", given what is known since step " + std::to_string(first) + " began") +
        ": " + impl_->conflictText(diagnosis.conflict_records);
    return diagnosis;
  }
  diagnosis.cost = optimum->price.total().sum();
  const Words words = impl_->words();
  const MinimalExplanations found =
      explanationsOf(impl_->program(), impl_->records(), impl_->currentStep(), *optimum);
  diagnosis.complete = found.complete;
  for (const PartExplanations& part : found.parts)
  {
    diagnosis.parts.push_back(inWords(part, words));
  }
  for (const auto& explanation : found.wholes)
  {
    ExplanationAlternative alternative = inWords(explanation, diagnosis.cost, words);
    diagnosis.explanations.push_back(statementsOf(alternative));
    diagnosis.in_words.push_back(alternative.in_words);
    diagnosis.alternatives.push_back(std::move(alternative));
  }
  if (first == 0)  // else what called for an assumption may be a record that is no longer kept
  {
    impl_->justify(diagnosis.alternatives, found.wholes,
                   std::min(found.wholes.size(), kMaxJustifiedAlternatives));
  }
  return diagnosis;
}

bool Reasoner::isConsistent() const
{
  const auto asked = impl_->ask("diagnosis");
  return impl_->optimum().has_value();
}

Diagnosis Reasoner::minimalExplanations() const
{
  const auto asked = impl_->ask("diagnosis");
  Diagnosis diagnosis;
  const std::optional<Optimum>& optimum = impl_->optimum();
  diagnosis.consistent = optimum.has_value();
  if (!optimum)
  {
    return diagnosis;
  }
  diagnosis.cost = optimum->price.total().sum();
  const Words words = impl_->words();
  const MinimalExplanations found =
      explanationsOf(impl_->program(), impl_->records(), impl_->currentStep(), *optimum);
  diagnosis.complete = found.complete;
  for (const auto& explanation : found.wholes)
  {
    diagnosis.explanations.emplace_back();
    for (const Clingo::Symbol& assumed : explanation)
    {
      diagnosis.explanations.back().push_back(words.statement(assumed));
    }
  }
  return diagnosis;
}

Explanation Reasoner::explain(const std::string& literal, int step) const
{
  const auto asked = impl_->ask("explanation");
  const Literal parsed = parseGroundLiteral(literal, impl_->description());
  Explanation explanation;
  if (!impl_->consequences(step).inAll(parsed, step))
  {
    return explanation;
  }
  return impl_->explain(parsed, step);
}

OpenQuestion Reasoner::whyUnknown(const std::string& text, int step) const
{
  const auto asked = impl_->ask("explanation");
  const Literal literal =
      normalized(parseGroundLiteral(text, impl_->description()), impl_->description());
  const Consequences& consequences = impl_->consequences(step);
  const Words words = impl_->words();
  const std::string fluent = toString(literal.atom);
  const std::string at = " at step " + std::to_string(step);
  OpenQuestion question;
  question.open = !consequences.inAll(literal, step) && consequences.inSome(literal, step);
  if (impl_->instances().isStatic(literal))
  {
    return question;  // a static is never open
  }
  question.values = possibleValues(fluent, step);
  if (!question.open)
  {
    question.reasons.push_back(words.text(literal) + at +
                               (consequences.inAll(literal, step) ? " is known" : " is excluded"));
    return question;
  }
  question.reasons.push_back(fluent + at + " may be " + listed(question.values));
  const std::vector<GroundDefault> defaults = impl_->program().firstStep() == 0
                                                  ? words.defaultsAbout(literal.atom)
                                                  : std::vector<GroundDefault>{};
  for (const GroundDefault& instance : defaults)
  {
    std::vector<std::string> unknown;
    for (const Literal& condition : instance.body)
    {
      if (!consequences.inAll(condition, 0))
      {
        unknown.push_back(words.text(condition));
      }
    }
    question.reasons.push_back(
        "default " + instance.name + " would say initially " + words.text(instance.head) +
        ", but " +
        (!unknown.empty() ? listed(unknown) + " initially is not known"
         : !consequences.inSome(instance.head, 0)
             ? "that is excluded"
             : "something else that is assumed or a default of equal rank contradicts it"));
  }
  const int now = currentStep();
  const std::vector<std::string> current = possibleValues(fluent, now);
  const bool decides = std::all_of(current.begin(), current.end(), [&](const std::string& value) {
    Record seen;
    seen.statement = toString(literalOf(impl_->groundFluent(fluent), value));
    seen.step = now;
    const Reasoner supposed = supposing({seen});
    return !supposed.impl_->optimum() || supposed.entails(text, step) != Answer::kUnknown;
  });
  if (decides && current.size() > 1)
  {
    question.deciding.push_back(fluent);
    question.reasons.push_back("observing " + fluent + " at step " + std::to_string(now) +
                               " would settle it");
  }
  return question;
}

}  // namespace kr3::reasoner
