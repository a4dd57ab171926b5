#include "explain.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

namespace kr3::reasoner
{

namespace
{

constexpr std::size_t kMaxWorlds = 8;

using Items = std::vector<CitedItem>;

/// Takes away as many items as it can so that `holds` stays true: first large pieces, then one
/// after the other until none can go.
Items shrunk(Items items, const std::function<bool(const Items&)>& holds)
{
  for (std::size_t chunk = (items.size() + 1) / 2; chunk > 0;
       chunk = chunk == 1 ? 0 : (chunk + 1) / 2)
  {
    for (bool smaller = true; smaller;)
    {
      smaller = false;
      for (std::size_t first = 0; first < items.size();)
      {
        Items fewer = items;
        const auto begin = fewer.begin() + static_cast<std::ptrdiff_t>(first);
        fewer.erase(begin, fewer.begin() +
                               static_cast<std::ptrdiff_t>(std::min(first + chunk, fewer.size())));
        if (holds(fewer))
        {
          items = std::move(fewer);
          smaller = chunk == 1;
        }
        else
        {
          first += chunk;
        }
      }
    }
  }
  return items;
}

void collectSentences(const Reason& reason, std::vector<std::string>& sentences)
{
  const bool repeated =
      reason.kind == ReasonKind::kAgain ||
      std::find(sentences.begin(), sentences.end(), reason.sentence) != sentences.end();
  if (!reason.sentence.empty() && !repeated)
  {
    sentences.push_back(reason.sentence);
  }
  for (const Reason& child : reason.children)
  {
    collectSentences(child, sentences);
  }
}

/// The first of the proof, in pre-order; nullptr when there is none.
const Reason* firstDefault(const Reason& proof)
{
  if (proof.kind == ReasonKind::kDefault)
  {
    return &proof;
  }
  for (const Reason& child : proof.children)
  {
    if (const Reason* found = firstDefault(child))
    {
      return found;
    }
  }
  return nullptr;
}

}  // namespace

std::string defaultBehind(const Explanation& explanation)
{
  if (explanation.defaults.empty())
  {
    return {};
  }
  const Reason* applied = firstDefault(explanation.proof);
  return applied == nullptr ? explanation.defaults.front() : applied->default_name;
}

std::vector<std::string> Explainer::sentencesOf(const Reason& reason)
{
  std::vector<std::string> sentences;
  collectSentences(reason, sentences);
  return sentences;
}

Reason Explainer::leafOf(const CitedItem& item) const
{
  Reason reason;
  switch (item.kind)
  {
    case CitedItem::Kind::kRecord:
    {
      const CheckedRecord& checked = records_[item.number];
      reason.kind = checked.isAction() ? ReasonKind::kHappened : ReasonKind::kObserved;
      reason.statement =
          checked.isAction() ? toString(checked.action) : words_.text(checked.literal);
      reason.step = checked.record.step;
      reason.record = item.number;
      reason.position = checked.record.position;
      reason.sentence = "the record " + withPlace(checked.record) + " rules out other explanations";
      break;
    }
    case CitedItem::Kind::kDefault:
      reason.default_name = item.name;
      reason.sentence = "the default " + item.name + " rules out other explanations";
      break;
    case CitedItem::Kind::kLaw:
    {
      const CitedLaw& law = laws_.law(item.number);
      reason.position = law.positions.front();
      const std::string place = placeOf(reason.position);
      reason.sentence = "the law" + (law.about.empty() ? "" : " about " + law.about) +
                        (place.empty() ? "" : " (" + place + ")") + " rules out other cases";
      break;
    }
  }
  return reason;
}

std::optional<Explainer::Argument> Explainer::argue(const Cited& kept, const Literal& literal,
                                                    int step)
{
  if (check_->firstStep() > 0)
  {
    return std::nullopt;  // the history was progressed: what its beginning rests on is not kept
  }
  const std::vector<InitialWorld> worlds = check_->worlds(kept, kMaxWorlds);
  std::vector<Argument> arguments;
  for (const InitialWorld& world : worlds)
  {
    auto argument = argueIn(kept, world, literal, step);
    if (!argument)
    {
      return std::nullopt;
    }
    const bool same = std::any_of(arguments.begin(), arguments.end(), [&](const Argument& other) {
      return sentencesOf(other.root) == sentencesOf(argument->root);
    });
    if (!same)
    {
      arguments.push_back(std::move(*argument));
    }
  }
  if (arguments.size() <= 1)
  {
    return arguments.empty() ? std::nullopt : std::make_optional(std::move(arguments.front()));
  }
  Argument cases;
  cases.root.kind = ReasonKind::kCases;
  cases.root.statement = words_.text(literal);
  cases.root.step = step;
  cases.root.sentence = cases.root.statement + " at step " + std::to_string(step) +
                        " in each of the cases that are left";
  for (Argument& argument : arguments)
  {
    cases.cited.insert(argument.cited);
    cases.root.children.push_back(std::move(argument.root));
  }
  return cases;
}

/// The last resort, without a proof. @param kept  without anything superfluous
Explainer::Argument Explainer::together(const Cited& kept, const Literal& literal, int step)
{
  Argument argument;
  argument.cited = kept;
  argument.root.statement = words_.text(literal);
  argument.root.step = step;
  argument.root.sentence = argument.root.statement + " at step " + std::to_string(step) +
                           " follows from these records together with the description";
  for (const CitedItem& item : itemsOf(argument.cited))
  {
    argument.root.children.push_back(leafOf(item));
  }
  if (check_->firstStep() > 0 && !check_->entailWithoutBeginning(argument.cited, literal, step))
  {
    Reason carried;
    carried.kind = ReasonKind::kCarried;
    carried.step = check_->firstStep();
    const std::string begun = "what was known when step " + std::to_string(carried.step) + " began";
    carried.sentence = begun + ", from records that are no longer kept";
    argument.root.children.push_back(std::move(carried));
    argument.root.sentence =
        argument.root.statement + " at step " + std::to_string(step) + " follows from " +
        (argument.cited.records.empty() ? begun : "these records, " + begun) +
        (argument.cited.records.empty() ? "" : ",") + " together with the description";
  }
  return argument;
}

/// Adds laws, records and defaults until what is cited suffices: they rule out other cases.
void Explainer::complete(Argument& argument, const Cited& kept, const Literal& literal, int step)
{
  Items cited = itemsOf(argument.cited);
  const auto isCited = [&](const CitedItem& item) {
    const Items& items = cited;
    return std::any_of(items.begin(), items.end(), [&](const CitedItem& other) {
      return other.kind == item.kind && other.number == item.number && other.name == item.name;
    });
  };
  while (!check_->entail(citedOf(cited), literal, step))
  {
    limit_.check();
    // the last of the shortest row of further items that suffices
    Items others = itemsOf(kept);
    others.erase(std::remove_if(others.begin(), others.end(), isCited), others.end());
    std::reverse(others.begin(), others.end());  // laws first
    if (others.empty())
    {
      return;
    }
    std::size_t enough = others.size();
    std::size_t little = 0;
    while (enough - little > 1)
    {
      const std::size_t middle = (little + enough) / 2;
      Items more = cited;
      more.insert(more.end(), others.begin(), others.begin() + static_cast<std::ptrdiff_t>(middle));
      (check_->entail(citedOf(more), literal, step) ? enough : little) = middle;
    }
    cited.push_back(others[enough - 1]);
    argument.root.children.push_back(leafOf(cited.back()));
  }
  argument.cited = citedOf(cited);
}

Cited Explainer::withoutSuperfluous(const Cited& cited, const Literal& literal, int step)
{
  return citedOf(shrunk(itemsOf(cited), [&](const Items& fewer) {
    limit_.check();
    return check_->entail(citedOf(fewer), literal, step);
  }));
}

Explanation Explainer::explain(const Literal& literal, int step)
{
  Cited kept = check_->all();
  Argument argument;
  for (;;)
  {
    auto found = argue(kept, literal, step);
    if (!found)
    {
      // with only what matters to the literal there are fewer cases
      kept = withoutSuperfluous(kept, literal, step);
      found = argue(kept, literal, step);
    }
    argument = found ? std::move(*found) : together(kept, literal, step);
    complete(argument, kept, literal, step);
    kept = withoutSuperfluous(argument.cited, literal, step);
    if (kept == argument.cited)
    {
      break;
    }
  }
  Explanation explanation;
  explanation.entailed = true;
  explanation.reasons = sentencesOf(argument.root);
  explanation.record_indices.assign(argument.cited.records.begin(), argument.cited.records.end());
  for (const std::size_t record : argument.cited.records)
  {
    explanation.records.push_back(toString(records_[record].record));
  }
  explanation.defaults.assign(argument.cited.defaults.begin(), argument.cited.defaults.end());
  for (const std::size_t law : argument.cited.laws)
  {
    explanation.laws.push_back(laws_.law(law));
  }
  explanation.proof = std::move(argument.root);
  return explanation;
}

}  // namespace kr3::reasoner
