#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "explain.hpp"

// Proofs in one initial world, and why its assumptions have to be made.
namespace kr3::reasoner
{

namespace
{

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
          common(a.assumed, b.assumed), b.laws};
}

/// Drops from the leaves whatever a proof can do without. What cannot be spared by all of them
/// cannot be spared by fewer: each is tried once. `prove` returns an inference or -1.
int minimized(Leaves& leaves, const std::function<int(const Leaves&)>& prove,
              const std::function<Leaves(int)>& leaves_of)
{
  const auto without = [&](auto Leaves::*items) {
    const auto all = leaves.*items;
    for (auto item = all.rbegin(); item != all.rend(); ++item)
    {
      Leaves fewer = leaves;
      if ((fewer.*items).erase(*item) == 0)
      {
        continue;  // gone with another one
      }
      const int inference = prove(fewer);
      if (inference >= 0)
      {
        leaves = common(leaves_of(inference), fewer);
      }
    }
  };
  without(&Leaves::defaults);
  without(&Leaves::assumed);
  without(&Leaves::records);
  return prove(leaves);
}

}  // namespace

std::optional<Explainer::Argument> Explainer::necessity(const Cited& kept,
                                                        const InitialWorld& world,
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
    HistoryTheory theory(description_, words_, instances_, records_, laws_, kept, without,
                         current_step_, about, wide, limit_);
    ProofWriter writer(theory, words_, without, records_);
    const auto refute = [&](const Leaves& leaves) {
      return theory.refute({&leaves.records, &leaves.defaults, &leaves.assumed}, excepted,
                           kMaxCases);
    };
    Leaves all;
    all.records = kept.records;
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
    const Leaves used = writer.leaves(inference);
    argument.cited = {leaves.records, leaves.defaults, used.laws, false};
    for (const GroundDefault& instance : excepted)
    {
      if (kept.hasDefault(instance.name))
      {
        argument.cited.defaults.insert(instance.name);
      }
    }
    return argument;
  }
  return std::nullopt;
}

std::optional<Explainer::Argument> Explainer::argueIn(const Cited& kept, const InitialWorld& world,
                                                      const Literal& literal, int step)
{
  for (const bool wide : {false, true})
  {
    HistoryTheory theory(description_, words_, instances_, records_, laws_, kept, world,
                         current_step_, literal.atom, wide, limit_);
    ProofWriter writer(theory, words_, world, records_);
    const auto prove = [&](const Leaves& leaves) {
      return theory.prove(literal, step, {&leaves.records, &leaves.defaults, &leaves.assumed},
                          kMaxCases);
    };
    Leaves leaves;
    leaves.records = kept.records;
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
    Argument argument{writer.written(inference, step),
                      {leaves.records, leaves.defaults, writer.leaves(inference).laws, false}};
    for (const Occurrence& occurrence : theory.rules().occurrences())
    {
      if (occurrence.failed && leaves.assumed.count(*occurrence.assumed) > 0)
      {
        argument.cited.records.insert(occurrence.record);  // only what was attempted can fail
      }
    }
    for (const std::size_t assumption : leaves.assumed)
    {
      if (auto needed = necessity(kept, world, assumption, literal.atom))
      {
        argument.cited.insert(needed->cited);
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

void Explainer::justify(ExplanationAlternative& alternative,
                        const std::vector<Clingo::Symbol>& assumed, const std::vector<bool>& known)
{
  Cited all;
  all.every_default = true;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    all.records.insert(i);
  }
  for (std::size_t i = 0; i < laws_.size(); ++i)
  {
    all.laws.insert(i);
  }
  InitialWorld world;
  world.assumed = assumed;
  for (std::size_t i = 0; i < assumed.size(); ++i)
  {
    const std::optional<Literal> subject = known[i] ? std::nullopt : words_.subject(assumed[i]);
    if (!subject)
    {
      continue;
    }
    const Atom fluent = words_.isException(assumed[i]) ? Atom{} : subject->atom;
    if (const auto needed = necessity(all, world, i, fluent))
    {
      Assumption& assumption = alternative.assumptions[i];
      assumption.because.assign(needed->cited.records.begin(), needed->cited.records.end());
      for (const std::string& sentence : sentencesOf(needed->root))
      {
        assumption.because_in_words += (assumption.because_in_words.empty() ? "" : "; ") + sentence;
      }
    }
  }
}

}  // namespace kr3::reasoner
