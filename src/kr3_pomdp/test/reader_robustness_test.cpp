// Files that nobody should write: broken, deep, huge.

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "fuzz/read_anything.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

const std::vector<std::string>& corpus()
{
  static const std::vector<std::string> kCorpus = [] {
    std::ostringstream mixed;
    writePomdpx(mixed, test::randomFactored(1));
    std::ostringstream flat;
    writePomdpx(flat, test::tiger());
    std::ostringstream appl;
    const Policy policy(2, {{0, {}, {-1.5, 2e-7}}, {2, {1}, {7.0}}});
    writeApplPolicy(appl, policy, test::tiger(), "m");
    std::ostringstream ours;
    policy.write(ours);
    return std::vector<std::string>{
        "discount: 0.95\nvalues: cost\nstates: left right 3rd\nactions: 2\nobservations: x y z\n"
        "start include: left 1\nT: 0 identity\nT: * : right uniform\nT: 1\nuniform\n"
        "T: 1 : 0 reset\nT: 1 : 3rd : * 0.0 # none\nT: 1 : 3rd : left 1.0\n"
        "O: * uniform\nO: 1 : 2\n0.5 0.25 0.25\nO: 0 : left : * 0\nO: 0 : left : y 1\n"
        "R: * : * : * : * -1\nR: 1 : left : right\n1 2 3\nR: 0 : 3rd\n1 2 3\n4 5 6\n7 8 9\n",
        mixed.str(),
        flat.str(),
        appl.str(),
        ours.str(),
        R"(<pomdpx version="1.0" id="dd"><Discount>0.9</Discount><Variable>
<StateVar vnamePrev="p0" vnameCurr="p1" fullyObs="true"><ValueEnum>a b</ValueEnum></StateVar>
<StateVar vnamePrev="q0" vnameCurr="q1"><NumValues>2</NumValues></StateVar>
<ActionVar vname="act"><ValueEnum>go stay</ValueEnum></ActionVar>
<ObsVar vname="see"><ValueEnum>yes no</ValueEnum></ObsVar><RewardVar vname="r"/></Variable>
<InitialStateBelief><CondProb><Var>p0</Var><Parent>null</Parent><Parameter type="DD"><DAG>
<SubDAG type="deterministic" var="p0" val="a"/></DAG></Parameter></CondProb>
<CondProb><Var>q0</Var><Parent>p0</Parent><Parameter type="TBL"><Entry><Instance>* -</Instance>
<ProbTable>uniform</ProbTable></Entry></Parameter></CondProb></InitialStateBelief>
<StateTransitionFunction><CondProb><Var>p1</Var><Parent>act p0</Parent><Parameter type="DD"><DAG>
<Node var="act"><Edge val="go"><SubDAG type="uniform" var="p1"/></Edge>
<Edge val="stay"><SubDAG type="template" idref="same"/></Edge></Node></DAG>
<SubDAGTemplate id="same"><SubDAG type="persistent" var="p1"/></SubDAGTemplate></Parameter></CondProb>
<CondProb><Var>q1</Var><Parent>q0 p1</Parent><Parameter type="TBL"><Entry><Instance>- * -</Instance>
<ProbTable>identity</ProbTable></Entry></Parameter></CondProb></StateTransitionFunction>
<ObsFunction><CondProb><Var>see</Var><Parent>q1</Parent><Parameter type="DD"><DAG><Node var="q1">
<Edge val="s0"><Node var="see"><Edge val="yes"><Terminal>0.75</Terminal></Edge>
<Edge val="no"><Terminal>0.25</Terminal></Edge></Node></Edge>
<Edge val="s1"><SubDAG type="uniform" var="see"/></Edge></Node></DAG></Parameter></CondProb></ObsFunction>
<RewardFunction><Func><Var>r</Var><Parent>act q0</Parent><Parameter type="DD"><DAG><Node var="act">
<Edge val="go"><Terminal>-1.5</Terminal></Edge></Node></DAG></Parameter></Func></RewardFunction></pomdpx>
)"};
  }();
  return kCorpus;
}

/// The words of a text with the blanks and signs between them.
std::vector<std::string> tokensOf(const std::string& text)
{
  const std::string signs = " \t\n:<>=\"/";
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const bool sign = signs.find(text[i]) != std::string::npos;
    if (sign || tokens.empty() || signs.find(tokens.back().front()) != std::string::npos)
    {
      tokens.emplace_back();
    }
    tokens.back() += text[i];
  }
  return tokens;
}

std::string mutated(const std::string& text, std::mt19937_64& random)
{
  static const std::vector<std::string> kWords = {
      "-1",        "0",       "1",    "2",      "0.5",
      "1e999",     "-1e-400", "nan",  "inf",    "99999999999",
      "300",       "*",       "-",    ":",      "#",
      "<",         ">",       "/",    "\"",     "\n",
      "start",     "T",       "null", "Node",   "Edge",
      "DAG",       "uniform", "left", "states", "identity",
      "Entry",     "TBL",     "DD",   "q0",     "see",
      "\r\n",      "&amp;",   "&#0;", "\xff",   std::string(1, '\0'),
      "<![CDATA[", "]]>",     "<!--"};
  std::vector<std::string> tokens = tokensOf(text);
  const std::size_t num_edits = 1 + random() % 4;
  for (std::size_t edit = 0; edit < num_edits && !tokens.empty(); ++edit)
  {
    const std::size_t at = random() % tokens.size();
    const auto place = tokens.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random() % 7)
    {
      case 0:
        tokens.erase(place);
        break;
      case 1:
        tokens.insert(place, std::string(*place));
        break;
      case 2:
        std::swap(*place, tokens[random() % tokens.size()]);
        break;
      case 3:
        tokens.resize(at);
        break;
      case 4:
        if (!place->empty())
        {
          (*place)[random() % place->size()] = static_cast<char>(random());
        }
        break;
      case 5:  // a part again: repeated statements, nested elements
      {
        const std::size_t length = 1 + random() % 20;
        const std::vector<std::string> part(
            place,
            tokens.begin() + static_cast<std::ptrdiff_t>(std::min(at + length, tokens.size())));
        tokens.insert(tokens.begin() + static_cast<std::ptrdiff_t>(random() % tokens.size()),
                      part.begin(), part.end());
        break;
      }
      default:
        *place = kWords[random() % kWords.size()];
    }
  }
  std::string result;
  for (const std::string& token : tokens)
  {
    result += token;
  }
  return result;
}

double cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::string messageOf(const std::string& text, bool xml)
{
  std::istringstream in(text);
  try
  {
    if (xml)
    {
      (void)readPomdpx(in, "f").flattened();
    }
    else
    {
      (void)readPomdp(in, "f");
    }
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return "no error";
}

TEST(ReaderRobustness, TheCorpusItselfIsRead)
{
  for (const std::string& text : corpus())
  {
    EXPECT_NO_THROW(readAnything(text));
  }
  std::istringstream flat(corpus()[0]);
  EXPECT_EQ(readPomdp(flat, "f").numStates(), 3U);
  std::istringstream diagram(corpus()[5]);
  EXPECT_EQ(readPomdpx(diagram, "f").flattened().numStates(), 4U);
}

// KR3_MUTATIONS sets how many; the sanitizers' builds run more.
TEST(ReaderRobustness, MutatedTextsAreReadOrRefusedWithTheirPlace)
{
  const char* const wanted = std::getenv("KR3_MUTATIONS");
  const std::uint64_t count = wanted == nullptr ? 4000 : std::strtoull(wanted, nullptr, 10);
  for (std::uint64_t seed = 0; seed < count && !HasFailure(); ++seed)
  {
    std::mt19937_64 random(seed);
    const std::string text = mutated(corpus()[seed % corpus().size()], random);
    const double start = cpuSeconds();
    SCOPED_TRACE("seed " + std::to_string(seed) + ":\n" + text.substr(0, 3000));
    EXPECT_NO_THROW(readAnything(text));
    EXPECT_LT(cpuSeconds() - start, 5.0);
  }
}

// What the fuzzer found, and what it began with. The large run is `./kr3 fuzz pomdp`.
TEST(ReaderRobustness, TheCorpusOfTheFuzzerIsReadOrRefused)
{
  std::size_t num_inputs = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(KR3_TEST_DIR) + "/corpus/readers"))
  {
    SCOPED_TRACE(file.path().filename());
    std::ifstream in(file.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    EXPECT_NO_THROW(readAnything(text));
    ++num_inputs;
  }
  EXPECT_GT(num_inputs, 100U);
}

TEST(ReaderRobustness, EveryBeginningOfATextIsReadOrRefused)
{
  for (const std::string& text : {corpus()[0], corpus()[3], corpus()[4], corpus()[5]})
  {
    for (std::size_t size = 0; size < text.size() && !HasFailure(); size += 3)
    {
      SCOPED_TRACE(text.substr(0, size));
      EXPECT_NO_THROW(readAnything(text.substr(0, size)));
    }
  }
}

TEST(ReaderRobustness, HugeSizesAreRefusedBeforeMemoryIsTaken)
{
  const std::string head = "discount: 0.9\nvalues: reward\n";
  EXPECT_EQ(messageOf(head + "states: 1000000000\n", false),
            "f:3:9: found '1000000000', expected the number of states, at most 10000000, or their "
            "names");
  EXPECT_EQ(messageOf(head + "states: 1e300\n", false).substr(0, 20), "f:3:9: found '1e300'");
  EXPECT_EQ(messageOf(head + "states: 5000000\nactions: 5000000\nobservations: 2\n", false),
            "a model of 25000000000000 rows (actions times states), expected at most 16777216");
  EXPECT_EQ(messageOf(head + "states: 100000\nactions: 2\nobservations: 2\nT: * uniform\n", false),
            "a model of 20000000000 entries of T and O, expected at most 134217728");
  const auto model = [](const std::string& num_values, const std::string& transition) {
    return "<pomdpx><Discount>0.9</Discount><Variable>\n<StateVar vnamePrev=\"a\" vnameCurr=\"b\">"
           "<NumValues>" +
           num_values +
           "</NumValues></StateVar>"
           "<ActionVar vname=\"c\"><NumValues>1000</NumValues></ActionVar><RewardVar vname=\"r\"/>"
           "</Variable><InitialStateBelief/>\n<StateTransitionFunction>" +
           transition + "</StateTransitionFunction><RewardFunction/></pomdpx>";
  };
  EXPECT_EQ(messageOf(model("1000000000", ""), true),
            "f:2:39: found '1000000000', expected a number of values from 1 to 1000000");
  EXPECT_EQ(
      messageOf(model("1000000", "\n<CondProb><Var>b</Var><Parent>a c</Parent></CondProb>"), true),
      "f:4:1: found tables of more than 134217728 entries, expected a model in smaller "
      "factors");
}

TEST(ReaderRobustness, IdentitiesCountAsWritten)
{
  std::istringstream in(
      "discount: 0.9\nvalues: reward\nstates: 500\nactions: 1\nobservations: 500\n"
      "T: * identity\nO: * identity\nT: * identity\n");
  ReadOptions options;
  options.max_entries = 1000;
  try
  {
    (void)readPomdp(in, "f", options);
    FAIL() << "was read";
  }
  catch (const ResourceExhausted& e)
  {
    EXPECT_STREQ(e.what(), "a model of 1001 entries of T and O, expected at most 1000");
  }
}

TEST(ReaderRobustness, RewardsThatAskForHoursAreRefused)
{
  const double start = cpuSeconds();
  EXPECT_EQ(messageOf("discount: 0.9\nvalues: reward\nactions: 1\nstates: 1000\n"
                      "observations: 2200\nT: * uniform\nO: * uniform\nR: * : * : * : 1 1\n",
                      false),
            "expected rewards of 2200000000 terms, expected at most 2147483648");
  const auto variable = [](const char* element, const char* names, const char* count) {
    return std::string("<") + element + " " + names + "><NumValues>" + count + "</NumValues></" +
           element + ">";
  };
  const auto uniform = [](const char* name) {
    return std::string("<CondProb><Var>") + name +
           "</Var><Parent>null</Parent><Parameter><Entry><Instance>-</Instance><ProbTable>uniform"
           "</ProbTable></Entry></Parameter></CondProb>";
  };
  EXPECT_EQ(messageOf("<pomdpx><Discount>0.9</Discount><Variable>" +
                          variable("StateVar", "vnamePrev=\"a\" vnameCurr=\"b\"", "1000") +
                          variable("ActionVar", "vname=\"c\"", "1") +
                          variable("ObsVar", "vname=\"o\"", "2200") +
                          "<RewardVar vname=\"r\"/></Variable><InitialStateBelief>" + uniform("a") +
                          "</InitialStateBelief><StateTransitionFunction>" + uniform("b") +
                          "</StateTransitionFunction><ObsFunction>" + uniform("o") +
                          "</ObsFunction><RewardFunction><Func><Var>r</Var><Parent>o</Parent>"
                          "<Parameter/></Func></RewardFunction></pomdpx>",
                      true),
            "a flat model of more than 2147483648 terms of expected rewards");
  EXPECT_LT(cpuSeconds() - start, 10.0);
}

TEST(ReaderRobustness, OptionsLimitFactoredModels)
{
  std::istringstream diagrams(corpus()[5]);
  ReadOptions options;
  options.max_names = 2;
  options.max_entries = 30;
  EXPECT_EQ(readPomdpx(diagrams, "f", options).state.size(), 2U);
  const auto refusal = [](const ReadOptions& limits) {
    std::istringstream in(corpus()[5]);
    try
    {
      (void)readPomdpx(in, "f", limits);
    }
    catch (const ResourceExhausted& e)
    {
      return std::string(e.what());
    }
    return std::string("read");
  };
  options.max_names = 1;
  EXPECT_EQ(refusal(options), "f:2:1: found a variable of 2 values, expected at most 1");
  options.max_names = 0;
  options.max_entries = 10;
  EXPECT_NE(refusal(options).find("tables of more than 10 entries"), std::string::npos);
  options.keep_going = [] { return false; };
  std::istringstream stopped(corpus()[5]);
  EXPECT_THROW((void)readPomdpx(stopped, "f", options), Cancelled);
}

TEST(ReaderRobustness, DeepAndCircularDiagramsEnd)
{
  const auto diagram = [](const std::string& dag, const std::string& templates) {
    return "<pomdpx><Discount>0.9</Discount><Variable><StateVar vnamePrev=\"a\" vnameCurr=\"b\">"
           "<ValueEnum>x y</ValueEnum></StateVar><ActionVar vname=\"c\"><NumValues>1</NumValues>"
           "</ActionVar><RewardVar vname=\"r\"/></Variable>\n<InitialStateBelief><CondProb><Var>a"
           "</Var><Parent>null</Parent><Parameter type=\"DD\">\n<DAG>" +
           dag + "</DAG>" + templates +
           "</Parameter></CondProb></InitialStateBelief><StateTransitionFunction/><RewardFunction/>"
           "</pomdpx>";
  };
  const std::string itself = "<SubDAG type=\"template\" idref=\"t\"/>";
  EXPECT_NE(
      messageOf(diagram(itself, "<SubDAGTemplate id=\"t\">" + itself + "</SubDAGTemplate>"), true)
          .find("a diagram that ends (does a template use itself?)"),
      std::string::npos);
  const std::string both = "<Node var=\"a\"><Edge val=\"x\">" + itself + "</Edge><Edge val=\"y\">" +
                           itself + "</Edge></Node>";
  EXPECT_NE(messageOf(diagram(both, "<SubDAGTemplate id=\"t\">" + both + "</SubDAGTemplate>"), true)
                .find("a diagram that ends"),
            std::string::npos);
  EXPECT_EQ(messageOf(diagram("<Node var=\"a\">\n<Edge val=\"x\"><Terminal>1</Terminal></Edge>"
                              "\n<Edge val=\"x\"><Terminal>1</Terminal></Edge></Node>",
                              ""),
                      true),
            "f:5:1: found a second edge for 'x', expected one for each value at most");
  std::string deep;
  for (int i = 0; i < 100000; ++i)
  {
    deep += "<Node var=\"a\"><Edge val=\"x\">";
  }
  EXPECT_NE(messageOf(deep, true).find("well-formed XML"), std::string::npos);
  for (int i = 0; i < 100000; ++i)
  {
    deep += "</Edge></Node>";
  }
  EXPECT_NE(messageOf(diagram(deep, ""), true).find("more than 200 levels"), std::string::npos);
}

TEST(ReaderRobustness, SumsThatAreOffNameTheirRowAndPlace)
{
  std::string text = corpus()[5];
  text.replace(text.find("0.75"), 4, "0.85");
  EXPECT_EQ(messageOf(text, true),
            "f:16:14: P(see | ...) given next q0 = s0 sums to 1.100000, expected 1");
}

}  // namespace
}  // namespace kr3::pomdp
