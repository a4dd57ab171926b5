#include "proof_writer.hpp"

#include <algorithm>
#include <utility>

namespace kr3::reasoner
{

namespace
{

std::string atStep(int step)
{
  return " at step " + std::to_string(step);
}

std::string inBrackets(const std::string& text)
{
  return text.empty() ? "" : " (" + text + ")";
}

bool sameReason(const Reason& a, const Reason& b)
{
  return a.sentence == b.sentence && a.kind == b.kind && a.record == b.record;
}

void append(std::vector<Reason>& reasons, std::vector<Reason> more)
{
  for (Reason& reason : more)
  {
    const bool known = std::any_of(reasons.begin(), reasons.end(), [&](const Reason& other) {
      return sameReason(other, reason) ||
             (reason.kind == ReasonKind::kAgain && other.statement == reason.statement &&
              other.step == reason.step);
    });
    if (!known)
    {
      reasons.push_back(std::move(reason));
    }
  }
}

}  // namespace

/// Behind what is implied by a value, the value.
int ProofWriter::resolved(int number) const
{
  const Inference& inference = theory_.inference(number);
  return inference.origin == Inference::kImplied ? resolved(inference.antecedents.front()) : number;
}

Reason ProofWriter::written(int inference, int step)
{
  std::vector<Reason> reasons = flattened(inference, step);
  if (reasons.size() == 1)
  {
    return std::move(reasons.front());
  }
  Reason together;
  together.children = std::move(reasons);
  return together;
}

std::vector<Reason> ProofWriter::flattened(int number, int step)
{
  const int shown = resolved(number);
  const Inference& inference = theory_.inference(shown);
  if (inference.literal.variable < 0)
  {
    return contradiction(shown);
  }
  const VariableMeaning& meaning = theory_.meaning(inference.literal.variable);
  if (!meaning.fluent)
  {
    if (meaning.occurrence && inference.antecedents.empty() && inference.origin >= 0)
    {
      return {leaf(inference, theory_.origin(inference.origin))};
    }
    return children(inference);
  }
  Reason reason = node(shown, inference);
  const bool own_step = inference.literal.step == step;
  if (own_step)
  {
    return {std::move(reason)};
  }
  Reason kept;
  kept.kind = ReasonKind::kInertia;
  kept.statement = reason.statement;
  kept.step = step;
  const bool forward = inference.literal.step < step;
  kept.sentence = kept.statement + (forward ? " holds" : " held already") + atStep(step) +
                  (forward ? " by inertia since step " : ", as at step ") +
                  std::to_string(inference.literal.step) +
                  (forward ? "" : ": nothing that happened in between can change it");
  kept.children.push_back(std::move(reason));
  return {std::move(kept)};
}

std::vector<Reason> ProofWriter::children(const Inference& inference)
{
  std::vector<Reason> reasons;
  for (std::size_t i = 0; i < inference.antecedents.size(); ++i)
  {
    append(reasons, flattened(inference.antecedents[i], inference.used_at[i]));
  }
  return reasons;
}

Reason ProofWriter::leaf(const Inference& inference, const ClauseOrigin& origin) const
{
  Reason reason;
  reason.kind = origin.kind;
  reason.step = origin.step;
  reason.record = origin.record;
  reason.position = origin.position;
  reason.default_name = origin.default_name;
  if (origin.record != kNoRecord)
  {
    const CheckedRecord& checked = records_[origin.record];
    const std::string place = placeOf(checked.record.position);
    if (!checked.isAction())
    {
      reason.statement = words_.text(checked.literal);
      reason.sentence = "observed" + atStep(origin.step) + ": " + reason.statement +
                        inBrackets(listed(nonEmpty({checked.record.source, place})));
      return reason;
    }
    const bool attempt = checked.record.kind == RecordKind::kAttempted;
    reason.statement = toString(checked.action);
    reason.sentence = "the action " + reason.statement +
                      (attempt ? " was attempted" + atStep(origin.step) + " and did not fail"
                               : " occurred" + atStep(origin.step)) +
                      inBrackets(place);
  }
  if (origin.assumed)
  {
    const Clingo::Symbol& assumed = world_.assumed[*origin.assumed];
    reason.sentence = words_.sentence(assumed) + ", because of what was observed";
    if (words_.isException(assumed))
    {
      reason.statement = words_.text(words_.exception(assumed));
      const auto excepted = words_.exceptedDefaults(assumed);
      reason.default_name = excepted.empty() ? "" : excepted.front().name;
      reason.position = excepted.empty() ? SourcePosition{} : excepted.front().rule->position;
    }
    else
    {
      reason.statement = words_.statement(assumed);
    }
  }
  static_cast<void>(inference);
  return reason;
}

/// Every other value excluded by the same law from the same premises: one step, not many.
bool ProofWriter::collapse(const Inference& inference, Reason& reason)
{
  const auto premises = [&](int number) {
    std::set<int> found;
    for (const int antecedent : theory_.inference(number).antecedents)
    {
      found.insert(resolved(antecedent));
    }
    return found;
  };
  const Inference& first = theory_.inference(resolved(inference.antecedents.front()));
  if (first.origin < 0 || first.antecedents.empty())
  {
    return false;
  }
  const ClauseOrigin& origin = theory_.origin(first.origin);
  const std::set<int> shared = premises(resolved(inference.antecedents.front()));
  for (const int antecedent : inference.antecedents)
  {
    const Inference& other = theory_.inference(resolved(antecedent));
    if (other.origin < 0 || theory_.origin(other.origin).kind != origin.kind ||
        theory_.origin(other.origin).step != origin.step ||
        theory_.origin(other.origin).position.line != origin.position.line ||
        premises(resolved(antecedent)) != shared)
    {
      return false;
    }
  }
  describe(reason, origin);
  reason.children = children(first);
  return true;
}

Reason ProofWriter::node(int number, const Inference& inference)
{
  Reason reason;
  reason.statement = words_.text(theory_.literalOf(inference.literal));
  reason.step = inference.literal.step;
  if (inference.origin >= 0 && inference.antecedents.empty() &&
      theory_.origin(inference.origin).kind != ReasonKind::kDefault &&
      (theory_.origin(inference.origin).record != kNoRecord ||
       theory_.origin(inference.origin).assumed))
  {
    return leaf(inference, theory_.origin(inference.origin));
  }
  if (!inference.antecedents.empty() && !shown_.insert(number).second)
  {
    reason.kind = ReasonKind::kAgain;
    reason.sentence = reason.statement + atStep(reason.step) + ", as shown";
    return reason;
  }
  if (inference.origin >= 0)
  {
    describe(reason, theory_.origin(inference.origin));
    reason.children = children(inference);
    return reason;
  }
  switch (inference.origin)
  {
    case Inference::kOnlyValue:
      if (!inference.antecedents.empty() && collapse(inference, reason))
      {
        return reason;
      }
      reason.kind = ReasonKind::kOnlyValue;
      reason.sentence = reason.statement + atStep(reason.step) + ": no other value is left";
      reason.children = children(inference);
      break;
    case Inference::kContradiction:
      reason.kind = ReasonKind::kContradiction;
      reason.sentence = reason.statement + atStep(reason.step) +
                        ", for the contrary would lead to a contradiction";
      reason.children = contradiction(inference.antecedents.front());
      break;
    default:
      reason.kind = ReasonKind::kSupposed;
      reason.sentence = "suppose " + reason.statement + atStep(reason.step);
      break;
  }
  return reason;
}

void ProofWriter::describe(Reason& reason, const ClauseOrigin& origin) const
{
  reason.kind = origin.kind;
  reason.position = origin.position;
  reason.default_name = origin.default_name;
  const std::string place = inBrackets(placeOf(origin.position));
  const std::string what = reason.statement + atStep(reason.step);
  switch (origin.kind)
  {
    case ReasonKind::kCaused:
      reason.sentence = what + " was caused by " + origin.action + atStep(origin.step - 1) + place;
      break;
    case ReasonKind::kInertia:
      reason.sentence = reason.step == origin.step
                            ? what + " by inertia since step " + std::to_string(origin.step - 1)
                            : what + ", as at step " + std::to_string(origin.step) +
                                  ": nothing that happened can have changed it";
      if (origin.silent)
      {
        reason.kind = ReasonKind::kChange;
        reason.sentence = what + ", for nothing else can have brought about the change";
      }
      break;
    case ReasonKind::kConstraint:
      reason.sentence = what + " by the state constraint" + place;
      break;
    case ReasonKind::kDefinition:
      reason.sentence = what + " by definition" + place;
      break;
    case ReasonKind::kExecutability:
      reason.sentence =
          what + ", for " + origin.action + " would have been impossible otherwise" + place;
      break;
    case ReasonKind::kDefault:
      reason.sentence = reason.statement + " initially, by default " + origin.default_name + place;
      break;
    case ReasonKind::kSupposed:
      reason.sentence = "suppose that default " + origin.default_name + " applied" + place + ": " +
                        reason.statement + " initially";
      break;
    default:
      reason.sentence = what;
      break;
  }
}

std::vector<Reason> ProofWriter::contradiction(int number)
{
  const Inference& inference = theory_.inference(number);
  std::vector<Reason> reasons;
  if (inference.origin >= 0)
  {
    const ClauseOrigin& origin = theory_.origin(inference.origin);
    if (!origin.silent && origin.position.line > 0)
    {
      Reason violated;
      violated.kind = origin.kind;
      violated.position = origin.position;
      violated.step = origin.step;
      violated.sentence =
          (origin.kind == ReasonKind::kExecutability ? origin.action + " would have been impossible"
                                                     : std::string("a law would be violated")) +
          atStep(origin.step) + inBrackets(placeOf(origin.position));
      violated.children = children(inference);
      reasons.push_back(std::move(violated));
      return reasons;
    }
  }
  if (inference.origin == Inference::kCases)
  {
    for (const int antecedent : inference.antecedents)
    {
      Reason one;
      one.kind = ReasonKind::kCases;
      one.sentence = "in one of two cases, which is impossible";
      one.children = contradiction(antecedent);
      reasons.push_back(std::move(one));
    }
    return reasons;
  }
  return children(inference);
}

Leaves ProofWriter::leaves(int number) const
{
  Leaves leaves;
  std::set<int> seen;
  std::vector<int> open = {number};
  while (!open.empty())
  {
    const int next = open.back();
    open.pop_back();
    if (!seen.insert(next).second)
    {
      continue;
    }
    const Inference& inference = theory_.inference(next);
    open.insert(open.end(), inference.antecedents.begin(), inference.antecedents.end());
    if (inference.origin < 0)
    {
      continue;
    }
    const ClauseOrigin& origin = theory_.origin(inference.origin);
    if (origin.record != kNoRecord && !origin.assumed)
    {
      leaves.records.insert(origin.record);
    }
    if (origin.law != kNoLaw)
    {
      leaves.laws.insert(origin.law);
    }
    if (!origin.default_name.empty())
    {
      leaves.defaults.insert(origin.default_name);
    }
    if (origin.assumed)
    {
      leaves.assumed.insert(*origin.assumed);
    }
  }
  return leaves;
}

}  // namespace kr3::reasoner
