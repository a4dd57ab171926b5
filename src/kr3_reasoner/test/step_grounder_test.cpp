// Grounding a step natively gives the same states, transitions, impossible actions and prices as
// grounding the text of Encoding with clingo.

#include "../src/step_grounder.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "../src/ground_fluents.hpp"
#include "../src/step_text.hpp"
#include "support.hpp"
#include "support/ground_solving.hpp"
#include "support/random_case.hpp"

namespace kr3::reasoner
{
namespace
{

using AtomId = GroundProgram::AtomId;

std::uint64_t environment(const char* name, std::uint64_t otherwise)
{
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoull(text);
}

class Step
{
public:
  Step(const std::vector<GroundFluent>& fluents, StepProgram program)
    : fluents_(fluents), program_(std::move(program))
  {
    for (const GroundFluent& fluent : fluents_)
    {
      first_value_.push_back(num_values_);
      num_values_ += fluent.values.size();
    }
  }

  [[nodiscard]] const StepProgram& program() const { return program_; }

  /// Some states, as sets of the numbers of the values that hold.
  std::set<TrueAtoms> someStates(std::uint64_t seed, std::size_t limit)
  {
    GroundSolving solving(seed);
    solving.add(program_.state);
    addFrame(solving, false);
    return values(solving.solve(shown(), {}, limit));
  }

  bool isState(const TrueAtoms& state)
  {
    GroundSolving solving;
    solving.add(program_.state);
    addFrame(solving, false);
    std::vector<std::int32_t> assumed;
    for (std::size_t v = 0; v < num_values_; ++v)
    {
      if (program_.now[v] != 0)
      {
        const auto atom = static_cast<std::int32_t>(program_.now[v]);
        assumed.push_back(state.count(static_cast<AtomId>(v)) > 0 ? atom : -atom);
      }
    }
    return !solving.solve(shown(), assumed).empty();
  }

  std::set<TrueAtoms> successors(const TrueAtoms& state, const std::set<std::size_t>& actions,
                                 std::size_t limit)
  {
    GroundSolving solving;
    addBefore(solving, state);
    solving.add(program_.state);
    solving.add(program_.effects);
    addFrame(solving, true);
    for (const std::size_t action : actions)
    {
      if (program_.occurs[action] != 0)
      {
        solving.addFact(program_.occurs[action]);
      }
    }
    return values(solving.solve(shown(), {}, limit));
  }

  /// The impossible actions, and for each action how many thousandths it costs.
  std::pair<std::set<std::size_t>, std::vector<long>> judged(const TrueAtoms& state)
  {
    std::vector<AtomId> asked;
    for (const AtomId atom : program_.impossible)
    {
      if (atom != 0)
      {
        asked.push_back(atom);
      }
    }
    GroundSolving executability;
    addBefore(executability, state);
    executability.add(program_.executability);
    const TrueAtoms impossible = *executability.solve(asked).begin();
    std::vector<AtomId> paid;
    for (const auto& prices : program_.prices_of)
    {
      for (const StepProgram::Price& price : prices)
      {
        paid.push_back(price.atom);
      }
    }
    GroundSolving prices;
    addBefore(prices, state);
    prices.add(program_.prices);
    const TrueAtoms due = *prices.solve(paid).begin();
    std::set<std::size_t> actions;
    std::vector<long> costs;
    for (std::size_t a = 0; a < program_.impossible.size(); ++a)
    {
      if (impossible.count(program_.impossible[a]) > 0)
      {
        actions.insert(a);
      }
      const auto& named = program_.prices_of[a];
      const auto largest = std::find_if(
          named.begin(), named.end(), [&](const auto& price) { return due.count(price.atom) > 0; });
      costs.push_back(largest == named.end() ? -1 : largest->cost_milli);
    }
    return {actions, costs};
  }

private:
  [[nodiscard]] std::vector<AtomId> shown() const
  {
    std::vector<AtomId> atoms;
    for (std::size_t v = 0; v < num_values_; ++v)
    {
      if (program_.now[v] != 0)
      {
        atoms.push_back(program_.now[v]);
      }
    }
    return atoms;
  }

  [[nodiscard]] std::set<TrueAtoms> values(const std::set<TrueAtoms>& models) const
  {
    std::set<TrueAtoms> states;
    for (const TrueAtoms& model : models)
    {
      TrueAtoms state;
      for (std::size_t v = 0; v < num_values_; ++v)
      {
        if (isAtom(v) && model.count(program_.now[v]) > 0)
        {
          state.insert(static_cast<AtomId>(v));
        }
      }
      states.insert(std::move(state));
    }
    return states;
  }

  /// The value `false` of a defined fluent is the absence of `true`.
  [[nodiscard]] bool isAtom(std::size_t value) const
  {
    const auto next = std::upper_bound(first_value_.begin(), first_value_.end(), value);
    const auto fluent = static_cast<std::size_t>(next - first_value_.begin()) - 1;
    return fluents_[fluent].kind != FluentKind::kDefined || value == first_value_[fluent] + 1;
  }

  /// What a Dynamics adds: one value for each fluent, which may be any or the one before.
  void addFrame(GroundSolving& solving, bool kept) const
  {
    GroundProgram frame;
    for (std::size_t f = 0; f < fluents_.size(); ++f)
    {
      if (fluents_[f].kind == FluentKind::kDefined)
      {
        continue;
      }
      std::vector<AtomId> group;
      for (std::size_t v = 0; v < fluents_[f].values.size(); ++v)
      {
        const AtomId now = program_.now[first_value_[f] + v];
        const auto before = static_cast<std::int32_t>(program_.before[first_value_[f] + v]);
        frame.addRule(true, {&now, &now + 1}, {&before, &before + (kept ? 1 : 0)});
        group.push_back(now);
      }
      solving.addExactlyOne(group);
    }
    solving.add(frame);
  }

  void addBefore(GroundSolving& solving, const TrueAtoms& state) const
  {
    for (const AtomId value : state)
    {
      solving.addFact(program_.before[value]);
    }
    // f != v lasts: the further atoms are derived from the state here as they would be there.
    for (std::size_t extra = num_values_; extra < program_.now.size(); ++extra)
    {
      GroundSolving derived;
      derived.add(program_.state);
      addFrame(derived, false);
      std::vector<std::int32_t> assumed;
      for (const AtomId value : state)
      {
        assumed.push_back(static_cast<std::int32_t>(program_.now[value]));
      }
      const std::set<TrueAtoms> models = derived.solve({program_.now[extra]}, assumed, 1);
      if (!models.empty() && !models.begin()->empty() && program_.before[extra] != 0)
      {
        solving.addFact(program_.before[extra]);
      }
    }
  }

  const std::vector<GroundFluent>& fluents_;
  StepProgram program_;
  std::vector<std::size_t> first_value_;
  std::size_t num_values_ = 0;
};

std::vector<GroundAction> actionsOf(const Description& description, bool exogenous)
{
  std::vector<GroundAction> actions;
  for (const ActionDeclaration& action : description.actions)
  {
    if (action.exogenous && !exogenous)
    {
      continue;
    }
    for (const auto& arguments : argumentTuples(action.argument_sorts, description))
    {
      actions.push_back({groundName(action.name, arguments), action.name, arguments});
    }
  }
  return actions;
}

/// Compares the two groundings in some states under some occurrences of actions.
void expectSameStep(const Description& description, bool exogenous, std::uint64_t seed,
                    std::size_t num_occurrences)
{
  constexpr std::size_t kStates = 3;
  constexpr std::size_t kSuccessors = 40;
  std::mt19937_64 random(seed);
  const std::vector<GroundFluent> fluents = groundFluents(description);
  const std::vector<GroundAction> actions = actionsOf(description, exogenous);
  Vocabulary vocabulary(description);
  const Statics statics(vocabulary);
  ASSERT_TRUE(canGroundStep(description));
  Step native(fluents, groundStep(vocabulary, statics, Signature(vocabulary, exogenous)));
  Step text(fluents, groundStepText(description, fluents, actions));
  std::set<TrueAtoms> states = native.someStates(seed + 1, kStates);
  for (const TrueAtoms& state : states)
  {
    ASSERT_TRUE(text.isState(state));
  }
  for (const TrueAtoms& state : text.someStates(seed + 2, kStates))
  {
    ASSERT_TRUE(native.isState(state));
    states.insert(state);
  }
  ASSERT_EQ(native.program().outcomes.empty(), text.program().outcomes.empty());
  for (const TrueAtoms& state : states)
  {
    ASSERT_EQ(native.judged(state), text.judged(state));
    for (std::size_t i = 0; i < num_occurrences && !actions.empty(); ++i)
    {
      std::set<std::size_t> occurring;
      for (std::size_t k = 0; k < i % 3; ++k)
      {
        occurring.insert(random() % actions.size());
      }
      const std::set<TrueAtoms> successors = native.successors(state, occurring, kSuccessors);
      if (successors.size() < kSuccessors)
      {
        ASSERT_EQ(successors, text.successors(state, occurring, kSuccessors));
      }
    }
  }
}

TEST(StepGrounder, AgreesWithTheTextOnEveryDomain)
{
  for (const auto& folder : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    SCOPED_TRACE(folder.path());
    const Description description = readDescription(folder.path() / "domain.kr3");
    if (canGroundStep(description))
    {
      expectSameStep(description, true, 1, 6);
    }
  }
}

TEST(StepGrounder, AgreesWithTheTextOnRandomDescriptions)
{
  const std::uint64_t first = environment("KR3_REASONER_SEED", 1);
  const std::uint64_t cases = environment("KR3_REASONER_CASES", 60);
  for (std::uint64_t seed = first; seed < first + cases && !HasFatalFailure(); ++seed)
  {
    const RandomCase drawn = randomCase(seed);
    SCOPED_TRACE(toString(drawn));
    expectSameStep(parseDescription(drawn.description, "random"), seed % 2 == 0, seed, 6);
  }
}

TEST(StepGrounder, LeavesRawCodeToClingo)
{
  EXPECT_FALSE(canGroundStep(
      parseDescription("sorts\n s = {a}.\nfluents\n inertial f(s).\nasp\n x_p(1).\n", "test")));
}

TEST(StepGrounder, TakesStaticsWhereOtherVariablesRestrictThem)
{
  // 400 places in a ring: the pairs of neighbours, not all pairs, are looked at, and a variable
  // that stands in no fluent adds no rules.
  std::string places = "p0";
  std::string facts;
  constexpr int kPlaces = 400;
  for (int i = 0; i < kPlaces; ++i)
  {
    places += i == 0 ? "" : ", p" + std::to_string(i);
    facts += " next(p" + std::to_string(i) + ", p" + std::to_string((i + 1) % kPlaces) + ").\n";
  }
  const Description description = parseDescription(
      "sorts\n place = {" + places + "}.\nstatics\n next(place, place).\nfacts\n" + facts +
          "fluents\n inertial at : place.\n inertial lit(place).\nactions\n go(place).\naxioms\n" +
          " go(P) causes at = Q if next(P, Q).\n lit(P) if next(P, Q), next(Q, R), at = R.\n" +
          " impossible go(P) if next(P, Q), lit(P).\n",
      "ring");
  Vocabulary vocabulary(description);
  const Statics statics(vocabulary);
  const StepProgram program = groundStep(vocabulary, statics, Signature(vocabulary, true));
  EXPECT_EQ(program.effects.rules().size(), kPlaces);
  EXPECT_EQ(program.state.rules().size(), kPlaces);
  EXPECT_EQ(program.executability.rules().size(), kPlaces);
}

TEST(Statics, AreDerivedStratumByStratum)
{
  const Description description = parseDescription(
      "sorts\n s = {a, b, c, d}.\n level = 1..3.\nstatics\n edge(s, s).\n reach(s, s).\n"
      " apart(s, s).\n rank(s) : level.\nfacts\n edge(a, b).\n edge(b, c).\n rank(a) = "
      "1.\nfluents\n"
      " inertial f(s).\naxioms\n reach(X, Y) if edge(X, Y).\n"
      " reach(X, Z) if reach(X, Y), reach(Y, Z).\n apart(X, Y) if -reach(X, Y), X != Y.\n"
      " rank(Y) = 2 if rank(X) = 1, edge(X, Y).\n",
      "graph");
  Vocabulary vocabulary(description);
  const Statics statics(vocabulary);
  const auto holds = [&](const std::string& literal) {
    const Literal parsed = parseGroundLiteral(literal, description);
    std::vector<ConstantId> arguments;
    for (const Term& argument : parsed.atom.arguments)
    {
      arguments.push_back(vocabulary.constant(argument.name));
    }
    return statics.holds(vocabulary.fluentSymbol(parsed.atom.name), arguments,
                         vocabulary.constant(parsed.value.name), parsed.equal);
  };
  EXPECT_TRUE(holds("reach(a, c)"));
  EXPECT_TRUE(holds("-reach(c, a)"));
  EXPECT_TRUE(holds("apart(c, a)"));
  EXPECT_FALSE(holds("apart(a, c)"));
  EXPECT_FALSE(holds("apart(a, a)"));
  EXPECT_TRUE(holds("rank(b) = 2"));
  EXPECT_FALSE(holds("rank(b) != 2"));
  EXPECT_TRUE(holds("rank(d) != 2"));
}

TEST(Statics, MayRestOnTheAbsenceOfOtherRowsOfThemselves)
{
  // A game: a position wins when a move leads to one that does not. Moves have no cycle.
  const Description description = parseDescription(
      "sorts\n s = {a, b, c, d, e}.\nstatics\n move(s, s).\n win(s).\nfacts\n move(a, b).\n"
      " move(b, c).\n move(c, d).\n move(a, e).\n move(e, c).\nfluents\n inertial f(s).\n"
      "axioms\n win(X) if move(X, Y), -win(Y).\n",
      "game");
  Vocabulary vocabulary(description);
  const Statics statics(vocabulary);
  const int win = vocabulary.fluentSymbol("win");
  std::string winning;
  for (const char* place : {"a", "b", "c", "d", "e"})
  {
    if (statics.holds(win, {vocabulary.constant(place)}, Vocabulary::kTrue, true))
    {
      winning += place;
    }
  }
  EXPECT_EQ(winning, "ac");
}

}  // namespace
}  // namespace kr3::reasoner
