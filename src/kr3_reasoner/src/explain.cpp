#include "explain.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

namespace kr3::reasoner
{

namespace
{

constexpr std::size_t kMaxWorlds = 8;
constexpr int kMaxCases = 200;

/// Gives the first node of an assumption the reasons why it had to be made.
bool attach(Reason& reason, const Reason& leaf, std::vector<Reason>& children)
{
  const bool assumption =
      reason.kind == ReasonKind::kException || reason.kind == ReasonKind::kAssumed;
  if (assumption && reason.sentence == leaf.sentence && reason.children.empty())
  {
    reason.children = std::move(children);
    return true;
  }
  return std::any_of(reason.children.begin(), reason.children.end(),
                     [&](Reason& child) { return attach(child, leaf, children); });
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

std::vector<std::string> sentencesOf(const Reason& reason)
{
  std::vector<std::string> sentences;
  collectSentences(reason, sentences);
  return sentences;
}

template <typename Item>
std::set<Item> common(const std::set<Item>& a, const std::set<Item>& b)
{
  std::set<Item> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(both, both.end()));
  return both;
}

Leaves common(const Leaves& a, const Leaves& b)
{
  return {common(a.records, b.records), common(a.defaults, b.defaults),
          common(a.assumed, b.assumed)};
}

/// Drops from the leaves whatever a proof can do without. `prove` returns an inference or -1.
int minimized(Leaves& leaves, const std::function<int(const Leaves&)>& prove,
              const std::function<Leaves(int)>& leaves_of)
{
  const auto without = [&](auto Leaves::*items) {
    for (bool smaller = true; smaller;)
    {
      smaller = false;
      const auto all = leaves.*items;
      for (auto item = all.rbegin(); item != all.rend() && !smaller; ++item)
      {
        Leaves fewer = leaves;
        (fewer.*items).erase(*item);
        const int inference = prove(fewer);
        if (inference >= 0)
        {
          leaves = common(leaves_of(inference), fewer);
          smaller = true;
        }
      }
    }
  };
  without(&Leaves::defaults);
  without(&Leaves::assumed);
  without(&Leaves::records);
  return prove(leaves);
}

}  // namespace

Explainer::Kept Explainer::only(const std::set<std::size_t>& records) const
{
  Kept kept(records_.size(), false);
  for (const std::size_t record : records)
  {
    kept[record] = true;
  }
  return kept;
}

Reason Explainer::recordLeaf(std::size_t record) const
{
  const CheckedRecord& checked = records_[record];
  Reason reason;
  reason.kind = checked.isAction() ? ReasonKind::kHappened : ReasonKind::kObserved;
  reason.statement = checked.isAction() ? toString(checked.action) : toString(checked.literal);
  reason.step = checked.record.step;
  reason.record = record;
  reason.position = checked.record.position;
  reason.sentence = "the record " + withPlace(checked.record) + " rules out other explanations";
  return reason;
}

std::optional<Explainer::Argument> Explainer::necessity(const Kept& kept, const InitialWorld& world,
                                                        std::size_t assumption, const Atom& fluent)
{
  const Clingo::Symbol assumed = world.assumed[assumption];
  InitialWorld without = world;
  without.assumed.erase(without.assumed.begin() + static_cast<std::ptrdiff_t>(assumption));
  const bool exception = words_.isException(assumed);
  const auto excepted = exception ? words_.exceptedDefaults(assumed) : std::vector<GroundDefault>{};
  const Atom about = exception ? words_.exception(assumed).atom : fluent;
  for (const bool wide : {false, true})
  {
    HistoryTheory theory(description_, words_, instances_, records_, kept, without, current_step_,
                         about, wide, limit_);
    ProofWriter writer(theory, words_, without, records_);
    const auto refute = [&](const Leaves& leaves) {
      return theory.refute({&leaves.records, &leaves.defaults, &leaves.assumed}, excepted,
                           kMaxCases);
    };
    Leaves all;
    for (std::size_t i = 0; i < kept.size(); ++i)
    {
      if (kept[i])
      {
        all.records.insert(i);
      }
    }
    for (const GroundDefault& instance : theory.rules().defaults())
    {
      all.defaults.insert(instance.name);
    }
    for (std::size_t i = 0; i < without.assumed.size(); ++i)
    {
      all.assumed.insert(i);
    }
    int inference = refute(all);
    if (inference < 0)
    {
      continue;
    }
    Leaves leaves = writer.leaves(inference);
    inference = minimized(leaves, refute, [&](int i) { return writer.leaves(i); });
    Argument argument;
    argument.root.children = writer.contradiction(inference);
    argument.records = leaves.records;
    argument.defaults = leaves.defaults;
    for (const GroundDefault& instance : excepted)
    {
      argument.defaults.insert(instance.name);
    }
    return argument;
  }
  return std::nullopt;
}

std::optional<Explainer::Argument> Explainer::argueIn(const Kept& kept, const InitialWorld& world,
                                                      const Literal& literal, int step)
{
  for (const bool wide : {false, true})
  {
    HistoryTheory theory(description_, words_, instances_, records_, kept, world, current_step_,
                         literal.atom, wide, limit_);
    ProofWriter writer(theory, words_, world, records_);
    const auto prove = [&](const Leaves& leaves) {
      return theory.prove(literal, step, {&leaves.records, &leaves.defaults, &leaves.assumed},
                          kMaxCases);
    };
    Leaves leaves;
    for (std::size_t i = 0; i < kept.size(); ++i)
    {
      if (kept[i])
      {
        leaves.records.insert(i);
      }
    }
    for (const GroundDefault& instance : theory.rules().defaults())
    {
      leaves.defaults.insert(instance.name);
    }
    for (std::size_t i = 0; i < world.assumed.size(); ++i)
    {
      leaves.assumed.insert(i);
    }
    int inference = prove(leaves);
    if (inference < 0)
    {
      continue;
    }
    leaves = writer.leaves(inference);
    inference = minimized(leaves, prove, [&](int i) { return writer.leaves(i); });
    Argument argument{writer.written(inference, step), leaves.records, leaves.defaults};
    for (const Occurrence& occurrence : theory.rules().occurrences())
    {
      if (occurrence.failed && leaves.assumed.count(*occurrence.assumed) > 0)
      {
        argument.records.insert(occurrence.record);  // only what was attempted can fail
      }
    }
    for (const std::size_t assumption : leaves.assumed)
    {
      if (auto needed = necessity(kept, world, assumption, literal.atom))
      {
        argument.records.insert(needed->records.begin(), needed->records.end());
        argument.defaults.insert(needed->defaults.begin(), needed->defaults.end());
        Reason leaf;
        leaf.sentence =
            words_.sentence(world.assumed[assumption]) + ", because of what was observed";
        attach(argument.root, leaf, needed->root.children);
      }
    }
    return argument;
  }
  return std::nullopt;
}

std::optional<Explainer::Argument> Explainer::argue(const Kept& kept, const Literal& literal,
                                                    int step)
{
  const std::vector<InitialWorld> worlds = check_->worlds(kept, nullptr, kMaxWorlds);
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
  cases.root.statement = toString(literal);
  cases.root.step = step;
  cases.root.sentence = cases.root.statement + " at step " + std::to_string(step) +
                        " in each of the cases that are left";
  for (Argument& argument : arguments)
  {
    cases.records.insert(argument.records.begin(), argument.records.end());
    cases.defaults.insert(argument.defaults.begin(), argument.defaults.end());
    cases.root.children.push_back(std::move(argument.root));
  }
  return cases;
}

/// The last resort: a minimal set of records, found by taking records away.
Explainer::Argument Explainer::together(const Kept& all, const Literal& literal, int step)
{
  Kept kept = all;
  for (std::size_t chunk = kept.size(); chunk > 0; chunk = chunk == 1 ? 0 : (chunk + 1) / 2)
  {
    for (bool smaller = true; smaller;)
    {
      smaller = false;
      for (std::size_t first = 0; first < kept.size(); first += chunk)
      {
        Kept fewer = kept;
        const auto begin = fewer.begin() + static_cast<std::ptrdiff_t>(first);
        std::fill(
            begin,
            fewer.begin() + static_cast<std::ptrdiff_t>(std::min(first + chunk, fewer.size())),
            false);
        if (fewer != kept && check_->entail(fewer, nullptr, literal, step))
        {
          kept = std::move(fewer);
          smaller = chunk == 1;
        }
      }
    }
  }
  Argument argument;
  argument.defaults = check_->defaultNames();
  argument.root.statement = toString(literal);
  argument.root.step = step;
  argument.root.sentence = argument.root.statement + " at step " + std::to_string(step) +
                           " follows from these records together with the description";
  for (std::size_t i = 0; i < kept.size(); ++i)
  {
    if (kept[i])
    {
      argument.records.insert(i);
      argument.root.children.push_back(recordLeaf(i));
    }
  }
  return argument;
}

/// Adds records until those cited suffice: they rule out other explanations.
void Explainer::complete(Argument& argument, const Kept& all, const Literal& literal, int step)
{
  while (!check_->entail(only(argument.records), nullptr, literal, step))
  {
    // the last of the shortest row of further records that suffices
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      if (all[i] && argument.records.count(i) == 0)
      {
        others.push_back(i);
      }
    }
    std::size_t enough = others.size();
    std::size_t little = 0;
    while (enough - little > 1)
    {
      const std::size_t middle = (little + enough) / 2;
      std::set<std::size_t> more = argument.records;
      more.insert(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(middle));
      (check_->entail(only(more), nullptr, literal, step) ? enough : little) = middle;
    }
    if (others.empty())
    {
      return;
    }
    const std::size_t added = others[enough - 1];
    argument.records.insert(added);
    argument.root.children.push_back(recordLeaf(added));
  }
}

Explanation Explainer::explain(const Literal& literal, int step)
{
  Kept kept(records_.size(), true);
  Argument argument;
  for (bool superfluous = true; superfluous;)
  {
    superfluous = false;
    auto found = argue(kept, literal, step);
    argument = found ? std::move(*found) : together(kept, literal, step);
    complete(argument, kept, literal, step);
    for (const std::size_t record : std::set<std::size_t>(argument.records))
    {
      std::set<std::size_t> fewer = argument.records;
      fewer.erase(record);
      if (!check_->entail(only(fewer), &argument.defaults, literal, step))
      {
        continue;
      }
      if (check_->entail(only(fewer), nullptr, literal, step))
      {
        kept = only(fewer);
        superfluous = true;
        break;
      }
      // the record keeps other defaults from interfering: they are mentioned, too
      std::set<std::string> all = check_->defaultNames();
      for (const std::string& name : check_->defaultNames())
      {
        std::set<std::string> less = all;
        less.erase(name);
        if (argument.defaults.count(name) == 0 &&
            !check_->entail(only(fewer), &less, literal, step))
        {
          all = std::move(less);
        }
      }
      argument.defaults = std::move(all);
    }
  }
  Explanation explanation;
  explanation.entailed = true;
  explanation.reasons = sentencesOf(argument.root);
  explanation.record_indices.assign(argument.records.begin(), argument.records.end());
  for (const std::size_t record : argument.records)
  {
    explanation.records.push_back(toString(records_[record].record));
  }
  explanation.defaults.assign(argument.defaults.begin(), argument.defaults.end());
  explanation.proof = std::move(argument.root);
  return explanation;
}

void Explainer::justify(ExplanationAlternative& alternative,
                        const std::vector<Clingo::Symbol>& assumed)
{
  const Kept all(records_.size(), true);
  InitialWorld world;
  world.assumed = assumed;
  for (std::size_t i = 0; i < assumed.size(); ++i)
  {
    const bool exception = words_.isException(assumed[i]);
    const AssumedAction action = words_.assumedAction(assumed[i]);
    Atom fluent;
    if (!exception && !records_.empty())
    {
      // any fluent that the action or the record is about
      const std::size_t wrong = words_.wrongRecord(assumed[i]);
      for (const CausalLaw& law : description_.causal_laws)
      {
        Binding binding;
        if (action.step >= 0 && unify(law.action, action.action, binding) &&
            !law.outcomes.empty() && !law.outcomes.front().effects.empty())
        {
          fluent = bound(law.outcomes.front().effects.front().fluent, binding);
        }
      }
      if (wrong != kNoRecord)
      {
        fluent = records_[wrong].literal.atom;
      }
    }
    const bool ground = std::none_of(fluent.arguments.begin(), fluent.arguments.end(),
                                     [](const Term& term) { return term.is_variable; });
    if (!exception && (fluent.name.empty() || !ground))
    {
      continue;
    }
    if (const auto needed = necessity(all, world, i, fluent))
    {
      Assumption& assumption = alternative.assumptions[i];
      assumption.because.assign(needed->records.begin(), needed->records.end());
      std::vector<std::string> sentences;
      for (const Reason& child : needed->root.children)
      {
        collectSentences(child, sentences);
      }
      for (const std::string& sentence : sentences)
      {
        assumption.because_in_words += (assumption.because_in_words.empty() ? "" : "; ") + sentence;
      }
    }
  }
}

}  // namespace kr3::reasoner
