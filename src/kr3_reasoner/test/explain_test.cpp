#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <variant>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"
#include "support/random_case.hpp"

// docs/semantics_tests.md, row 10: what is cited suffices, and nothing cited is superfluous.
namespace kr3::reasoner
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3";
const std::string kWorkbench = std::string(KR3_DOMAINS_DIR) + "/workbench/domain.kr3";
const std::string kLamps = std::string(KR3_TEST_DIR) + "/data/lamps.kr3";

Reasoner reasonerOf(const std::string& path, const std::string& history,
                    ReasonerOptions options = {})
{
  Reasoner reasoner(readDescription(path), std::move(options));
  reasoner.setHistory(parseHistory(history, "mission.hist", reasoner.description()));
  return reasoner;
}

std::string joined(const std::vector<std::string>& lines)
{
  std::string text;
  for (const std::string& line : lines)
  {
    text += line + "\n";
  }
  return text;
}

Term bound(const Term& term, const std::map<std::string, std::string>& binding)
{
  const auto found = binding.find(term.name);
  return term.is_variable && found != binding.end() ? Term{false, found->second} : term;
}

/// The description with those instances only of its defaults.
Description withDefaults(Description description, const std::vector<std::string>& names)
{
  std::vector<Default> kept;
  for (const Default& rule : description.defaults)
  {
    for (const std::string& name : names)
    {
      std::vector<std::string> arguments;
      std::string text = name.substr(0, name.find('('));
      if (text != rule.name.name)
      {
        continue;
      }
      std::string rest = name.size() > text.size() ? name.substr(text.size() + 1) : "";
      for (std::size_t i = 0; i < rule.name.arguments.size(); ++i)
      {
        const std::size_t end = rest.find_first_of(",)");
        arguments.push_back(rest.substr(0, end));
        rest = rest.substr(std::min(rest.size(), end + 2));
      }
      std::map<std::string, std::string> binding;
      for (std::size_t i = 0; i < arguments.size(); ++i)
      {
        binding[rule.name.arguments[i].name] = arguments[i];
      }
      const auto bindAll = [&](std::vector<Term>& terms) {
        std::transform(terms.begin(), terms.end(), terms.begin(),
                       [&](const Term& term) { return bound(term, binding); });
      };
      Default instance = rule;
      bindAll(instance.name.arguments);
      bindAll(instance.head.atom.arguments);
      instance.head.value = bound(instance.head.value, binding);
      for (Condition& condition : instance.body)
      {
        if (auto* literal = std::get_if<Literal>(&condition))
        {
          bindAll(literal->atom.arguments);
          literal->value = bound(literal->value, binding);
        }
        else if (auto* comparison = std::get_if<Comparison>(&condition))
        {
          comparison->left = bound(comparison->left, binding);
          comparison->right = bound(comparison->right, binding);
        }
        else
        {
          auto& membership = std::get<Membership>(condition);
          membership.term = bound(membership.term, binding);
        }
      }
      kept.push_back(std::move(instance));
    }
  }
  description.defaults = std::move(kept);
  return description;
}

bool isAt(const SourcePosition& position, const std::vector<CitedLaw>& laws)
{
  return std::any_of(laws.begin(), laws.end(), [&](const CitedLaw& law) {
    return std::any_of(law.positions.begin(), law.positions.end(),
                       [&](const SourcePosition& other) {
      return other.file == position.file && other.line == position.line &&
             other.column == position.column;
    });
  });
}

template <typename Rule>
void keepOnly(const std::vector<CitedLaw>& laws, const std::function<bool(const Rule&)>& always,
              std::vector<Rule>& rules)
{
  rules.erase(
      std::remove_if(rules.begin(), rules.end(),
                     [&](const Rule& rule) { return !always(rule) && !isAt(rule.position, laws); }),
      rules.end());
}

/// The description with these laws only. Defined fluents that lose their definition may have any
/// value; rules for statics and conditions on several actions stay.
Description withLaws(Description description, const std::vector<CitedLaw>& laws)
{
  for (const FluentDeclaration& fluent : description.fluents)
  {
    const bool is_cited = std::any_of(laws.begin(), laws.end(), [&](const CitedLaw& law) {
      return law.kind == LawKind::kDefinition && law.about == fluent.name;
    });
    const bool has_rules =
        std::any_of(description.constraints.begin(), description.constraints.end(),
                    [&](const StateConstraint& rule) {
      return rule.head && rule.head->atom.name == fluent.name;
        });
    if (fluent.kind != FluentKind::kDefined || is_cited || !has_rules)
    {
      continue;
    }
    std::string atom = fluent.name;
    std::string sorts;
    for (std::size_t i = 0; i < fluent.argument_sorts.size(); ++i)
    {
      const std::string variable = "X" + std::to_string(i);
      atom += (i == 0 ? "(" : ",") + variable;
      sorts += (i == 0 ? " :- sort(" : ", sort(") + fluent.argument_sorts[i] + "," + variable + ")";
    }
    atom += fluent.argument_sorts.empty() ? "" : ")";
    AspBlock block;
    block.part = AspPart::kState;
    block.text = "{ h(" + atom + ",true,t) }" + sorts + ".";
    description.asp_blocks.push_back(block);
  }
  keepOnly<CausalLaw>(
      laws, [](const CausalLaw&) { return false; }, description.causal_laws);
  keepOnly<StateConstraint>(
      laws,
      [&](const StateConstraint& rule) {
    return rule.head && description.findFluent(rule.head->atom.name)->kind == FluentKind::kStatic;
      },
      description.constraints);
  keepOnly<Executability>(
      laws,
      [](const Executability& rule) {
    return rule.actions.size() > 1 || std::holds_alternative<Term>(rule.actions.front());
      },
      description.executabilities);
  return description;
}

/// What an explanation cites.
struct Citation
{
  std::vector<std::size_t> records;
  std::vector<std::string> defaults;
  std::vector<CitedLaw> laws;
};

/// Whether what is cited entails the literal, with everything else taken away.
bool entailedBy(const Citation& cited, const Reasoner& whole, ReasonerOptions options,
                const std::string& literal, int step)
{
  options.least_step = whole.currentStep();
  Reasoner reasoner(withLaws(withDefaults(whole.description(), cited.defaults), cited.laws),
                    options);
  std::vector<Record> kept;
  for (const std::size_t record : cited.records)
  {
    kept.push_back(whole.history()[record]);
  }
  reasoner.setHistory(std::move(kept));
  return reasoner.diagnose().consistent && reasoner.entails(literal, step) == Answer::kTrue;
}

/// Each citation that lacks one of the items of a kind.
template <typename Item>
std::vector<Citation> withoutOne(const Citation& cited, std::vector<Item> Citation::*items)
{
  std::vector<Citation> lacking;
  for (std::size_t i = 0; i < (cited.*items).size(); ++i)
  {
    lacking.push_back(cited);
    (lacking.back().*items).erase((lacking.back().*items).begin() + static_cast<std::ptrdiff_t>(i));
  }
  return lacking;
}

/// Every leaf of a proof is cited, and every record cited is in the proof.
void collectRecords(const Reason& reason, std::set<std::size_t>& records)
{
  if (reason.record != kNoRecord)
  {
    records.insert(reason.record);
  }
  for (const Reason& child : reason.children)
  {
    collectRecords(child, records);
  }
}

std::vector<std::string> placesOf(const std::vector<CitedLaw>& laws)
{
  std::vector<std::string> places;
  for (const CitedLaw& law : laws)
  {
    for (const SourcePosition& position : law.positions)
    {
      places.push_back(law.about + " " + position.file + ":" + std::to_string(position.line));
    }
  }
  return places;
}

bool isFallback(const Reason& reason)
{
  return reason.kind == ReasonKind::kTogether;
}

void expectMinimalAndSufficient(const Reasoner& reasoner, const ReasonerOptions& options,
                                const std::string& literal, int step, const std::string& note)
{
  const Explanation explanation = reasoner.explain(literal, step);
  const std::string message =
      note + "\n" + literal + " at " + std::to_string(step) + "\n" + joined(explanation.reasons) +
      "records:\n" + joined(explanation.records) + "defaults:\n" + joined(explanation.defaults) +
      "laws:\n" + joined(placesOf(explanation.laws));
  ASSERT_TRUE(explanation.entailed) << message;
  const Citation cited = {explanation.record_indices, explanation.defaults, explanation.laws};
  EXPECT_TRUE(entailedBy(cited, reasoner, options, literal, step)) << "not sufficient: " << message;
  const auto expectNeeded = [&](const std::vector<Citation>& lacking, const std::string& what) {
    for (std::size_t i = 0; i < lacking.size(); ++i)
    {
      EXPECT_FALSE(entailedBy(lacking[i], reasoner, options, literal, step))
          << "superfluous: " << what << " " << i << "\n"
          << message;
    }
  };
  expectNeeded(withoutOne(cited, &Citation::records), "record");
  expectNeeded(withoutOne(cited, &Citation::defaults), "default");
  expectNeeded(withoutOne(cited, &Citation::laws), "law");
  std::set<std::size_t> in_proof;
  collectRecords(explanation.proof, in_proof);
  EXPECT_EQ(in_proof, std::set<std::size_t>(cited.records.begin(), cited.records.end())) << message;
}

/// Checks some of the entailed literals, spread over steps and fluents.
void expectManyExplained(const Reasoner& reasoner, std::size_t stride)
{
  std::size_t count = 0;
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    for (const Literal& literal : reasoner.entailedAt(step))
    {
      if (count++ % stride == 0)
      {
        expectMinimalAndSufficient(reasoner, {}, toString(literal), step, "");
      }
    }
  }
}

TEST(Explain, SaysByWhichDefaultAndFromWhichObservation)
{
  const Explanation explanation =
      reasonerOf(kOffice,
                 "init(loc(rob1) = office, true).\nobs(loc(tb1) = main_library, false, 1).")
          .explain("loc(tb1) = aux_library", 1);
  EXPECT_EQ(explanation.record_indices, std::vector<std::size_t>{1});
  EXPECT_EQ(explanation.defaults, (std::vector<std::string>{"d1(tb1)", "d2(tb1)"}));
  const Reason& inertia = explanation.proof;
  EXPECT_EQ(inertia.kind, ReasonKind::kInertia);
  ASSERT_EQ(inertia.children.size(), 1U);
  const Reason& by_default = inertia.children[0];
  EXPECT_EQ(by_default.kind, ReasonKind::kDefault);
  EXPECT_EQ(by_default.default_name, "d2(tb1)");
  EXPECT_GT(by_default.position.line, 0);
  ASSERT_EQ(by_default.children.size(), 1U);
  const Reason& exception = by_default.children[0];
  EXPECT_EQ(exception.kind, ReasonKind::kException);
  EXPECT_EQ(exception.default_name, "d1(tb1)");
  EXPECT_EQ(defaultBehind(explanation), "d2(tb1)");
  std::set<std::size_t> because;
  collectRecords(exception, because);
  EXPECT_EQ(because, std::set<std::size_t>{1});
  const std::string words = joined(explanation.reasons);
  EXPECT_NE(words.find("observed at step 1: loc(tb1) != main_library (robot and mission.hist:2)"),
            std::string::npos)
      << words;
}

TEST(Explain, PrefersWhatWasObservedToADefaultThatSaysTheSame)
{
  const Explanation explanation = reasonerOf(kOffice, "obs(loc(tb1) = main_library, true, 0).")
                                      .explain("loc(tb1) = main_library", 0);
  EXPECT_EQ(explanation.proof.kind, ReasonKind::kObserved);
  EXPECT_EQ(explanation.records.size(), 1U);
  EXPECT_TRUE(explanation.defaults.empty());
}

TEST(Explain, NamesTheActionAndItsLaw)
{
  const Explanation explanation =
      reasonerOf(kOffice,
                 "init(loc(rob1) = office, true). hpd(move(rob1, kitchen), 0). "
                 "hpd(move(rob1, office), 1).")
          .explain("loc(rob1) = kitchen", 1);
  EXPECT_EQ(explanation.proof.kind, ReasonKind::kCaused);
  EXPECT_EQ(explanation.record_indices, std::vector<std::size_t>{1});
  EXPECT_NE(joined(explanation.reasons).find("caused by move(rob1, kitchen) at step 0"),
            std::string::npos);
  EXPECT_NE(explanation.proof.position.file.find("domain.kr3"), std::string::npos);
}

TEST(Explain, SaysThatAnActionWouldHaveBeenImpossible)
{
  const Explanation explanation =
      reasonerOf(kOffice, "init(loc(rob1) = kitchen, true). hpd(grasp(rob1, mug1), 0).")
          .explain("loc(mug1) = kitchen", 0);
  EXPECT_EQ(explanation.record_indices, (std::vector<std::size_t>{0, 1}));
  EXPECT_NE(joined(explanation.reasons).find("would have been impossible"), std::string::npos)
      << joined(explanation.reasons);
}

TEST(Explain, CitesWhatSufficesAndNothingElse)
{
  expectManyExplained(
      reasonerOf(kOffice,
                 "init(loc(rob1) = office, true). obs(loc(tb1) = main_library, false, 1). "
                 "hpd(move(rob1, aux_library), 0). obs(loc(tb2) = main_library, false, 2). "
                 "obs(loc(tb2) = aux_library, false, 2). hpd(grasp(rob1, tb1), 1). "
                 "hpd(move(rob1, kitchen), 2). obs(loc(tb3) = main_library, true, 3)."),
      37);
  expectManyExplained(
      reasonerOf(kWorkbench,
                 "init(opened(psu), false). hpd(unscrew(tech1, psu), 0). obs(cause(hum) = psu, "
                 "false, 1). obs(cause(silence) = psu, true, 1). init(resolved(silence), false). "
                 "hpd(replace(tech1, psu, silence), 1)."),
      7);
  expectManyExplained(
      reasonerOf(kLamps,
                 "init(on(left), false). init(on(right), false). hpd(flip(left), 0). "
                 "obs(lit(red), false, 1). hpd(flip(right), 1). hpd(roll(d), 2)."),
      7);
}

TEST(Explain, CitesWhatSufficesAndNothingElseOfALongHistory)
{
  expectManyExplained(
      reasonerOf(kOffice,
                 "init(loc(rob1) = office, true). hpd(move(rob1, main_library), 0). "
                 "obs(loc(tb1) = main_library, false, 1). hpd(grasp(rob1, tb2), 1). "
                 "hpd(move(rob1, kitchen), 2). obs(loc(tb3) = main_library, false, 30)."),
      911);
}

TEST(Explain, ProvesWhatManyOtherCasesDoNotTouch)
{
  // each of six machines is either worn or was kicked: 64 explanations, of equal price
  std::string text =
      "sorts\n machine = {m1, m2, m3, m4, m5, m6}.\nfluents\n inertial worn(machine).\n"
      " inertial kicked(machine).\n inertial loud(machine).\n inertial warm.\naxioms\n"
      " false if loud(M), -worn(M), -kicked(M).\ndefaults\n d(M): -worn(M).\n e(M): -kicked(M).\n"
      " w: warm.\n";
  std::string history;
  for (int machine = 1; machine <= 6; ++machine)
  {
    history += "obs(loud(m" + std::to_string(machine) + "), true, 1).\n";
  }
  Reasoner reasoner(parseDescription(text, "machines"));
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  ASSERT_EQ(reasoner.diagnose().explanations.size(), 64U);
  EXPECT_EQ(reasoner.explain("warm", 1).defaults, std::vector<std::string>{"w"});
  EXPECT_EQ(defaultBehind(reasoner.explain("warm", 1)), "w");
  for (const char* const literal : {"warm", "loud(m3)"})
  {
    expectMinimalAndSufficient(reasoner, {}, literal, 1, "");
    EXPECT_FALSE(isFallback(reasoner.explain(literal, 1).proof)) << literal;
  }
}

// KR3_EXPLAIN_CASES and KR3_EXPLAIN_SEED in the environment run more of them.
TEST(Explain, CitesWhatSufficesAndNothingElseInRandomHistories)
{
  const auto number = [](const char* name, int otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atoi(text);
  };
  const int first = number("KR3_EXPLAIN_SEED", 1);
  const int cases = number("KR3_EXPLAIN_CASES", 12);
  int explained = 0;
  int fallbacks = 0;
  for (int seed = first; seed < first + cases && !HasFailure(); ++seed)
  {
    const RandomCase random_case = randomCase(static_cast<std::uint64_t>(seed));
    Reasoner reasoner(parseDescription(random_case.description, "case"), random_case.options);
    reasoner.setHistory(parseHistory(random_case.history, "history", reasoner.description()));
    if (!reasoner.diagnose().consistent)
    {
      continue;
    }
    const int step = seed % (reasoner.currentStep() + 1);
    const std::vector<Literal> literals = reasoner.entailedAt(step);
    for (std::size_t i = 0; i < literals.size() && i < 2; ++i)
    {
      const Literal& literal = literals[(i * 7 + static_cast<std::size_t>(seed)) % literals.size()];
      expectMinimalAndSufficient(reasoner, random_case.options, toString(literal), step,
                                 toString(random_case));
      ++explained;
      fallbacks += isFallback(reasoner.explain(toString(literal), step).proof) ? 1 : 0;
    }
  }
  RecordProperty("explained", explained);
  EXPECT_GT(explained, cases / 2);
  EXPECT_LE(fallbacks * 10, explained) << fallbacks << " of " << explained << " without a proof";
}

}  // namespace
}  // namespace kr3::reasoner
