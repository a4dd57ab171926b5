// kr3_zoom as a person runs it.

#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include <kr3_pomdp/pomdp_format.hpp>
#include <kr3_pomdp/pomdpx_format.hpp>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

struct Outcome
{
  int exit_code = 0;
  std::string output;  // stdout and stderr
};

Outcome run(const std::string& arguments)
{
  const std::string command = std::string(KR3_TOOLS_DIR) + "/kr3_zoom " + arguments + " 2>&1";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr)
  {
    throw std::runtime_error("cannot run " + command);
  }
  Outcome result;
  std::array<char, 4096> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe))
  {
    result.output.append(buffer.data(), size);
  }
  result.exit_code = WEXITSTATUS(pclose(pipe));
  return result;
}

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";
const std::string kGrasp = kOffice +
                           " --state 'loc(rob1)=main_library, loc(tb1)=main_library'"
                           " --action 'grasp(rob1, tb1)' --known 'loc(rob1)=main_library_c0'"
                           " --hidden 'loc(tb1)=0.8'";

void expectSays(const Outcome& outcome, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(outcome.output.find(part), std::string::npos)
        << "expected: " << part << "\nin: " << outcome.output;
  }
}

TEST(ZoomTool, TellsWhatMattersAndWhatThePomdpIs)
{
  const Outcome outcome = run(kGrasp + " --solve 0.05");
  EXPECT_EQ(outcome.exit_code, 0);
  expectSays(outcome,
             {"main_library: value of loc(rob1), on which grasp(rob1, tb1) depends",
              "Effects to bring about:\n  in_hand(rob1, tb1)", "cell = {main_library_c0, ",
              "26 states (24 physical, boundary, done), 11 actions, 8 observations",
              "move (4), grasp, putdown, search (4), finish", "loc(rob1), 4 values, always known",
              "loc(tb1), 5 values, hidden", "elsewhere 0.20",
              "24 of 24 physical states can come about", "Solved: bounds "});
}

TEST(ZoomTool, NamesWhatNeverComesAbout)
{
  const std::string workbench = std::string(KR3_DOMAINS_DIR) + "/workbench";
  const Outcome outcome = run(workbench + " --map " + workbench +
                              "/map.yaml --state 'opened(psu), cause(hum)=psu' --action "
                              "'replace(tech1, psu, hum)' --known 'cause(hum)=rectifier' "
                              "--names 1");
  EXPECT_EQ(outcome.exit_code, 0);
  expectSays(outcome, {"16 of 48 physical states can come about",
                       "states that never come about: 32\n    ", "and 31 more"});
}

TEST(ZoomTool, WritesBothFormats)
{
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / ("kr3_zoom_test_" + std::to_string(getpid()));
  std::filesystem::create_directory(directory);
  const std::string flat = directory / "grasp.pomdp";
  const std::string numbered = directory / "numbered.pomdp";
  const std::string factors = directory / "grasp.pomdpx";
  EXPECT_EQ(run(kGrasp + " --pomdp " + flat + " --pomdpx " + factors).exit_code, 0);
  EXPECT_EQ(run(kGrasp + " --numbered --pomdp " + numbered).exit_code, 0);
  EXPECT_EQ(pomdp::loadPomdp(flat).numStates(), 26U);
  EXPECT_TRUE(pomdp::loadPomdp(flat).findAction("grasp(rob1,tb1)"));
  EXPECT_FALSE(pomdp::loadPomdp(numbered).findAction("grasp(rob1,tb1)"));
  const pomdp::FactoredModel read = pomdp::loadPomdpx(factors);
  EXPECT_EQ(read.state.size(), 4U);
  EXPECT_TRUE(read.state[1].observed);
  std::filesystem::remove_all(directory);
}

TEST(ZoomTool, ZoomsNothingAwayOnRequest)
{
  const Outcome outcome = run(kOffice +
                              " --cells-per-place 1 --state 'loc(rob1)=office' --flat "
                              "--goal 'in_hand(rob1, tb1)' --max-states 50");
  EXPECT_EQ(outcome.exit_code, 1);  // eight things in six places
  expectSays(outcome, {"Relevant to whole domain:", "corridor: nothing is zoomed away",
                       "more than 50 states"});
}

TEST(ZoomTool, SaysWhatIsWrong)
{
  struct Wrong
  {
    std::string arguments;
    std::string message;
  };
  const std::vector<Wrong> cases{
      {kOffice + " --state 'loc(rob1)=office'", "--action is missing"},
      {kGrasp + " --goal 'loc(tb1)=office'", "--goal is for --flat"},
      {kGrasp + " --numbered", "--numbered is for --pomdp"},
      {kGrasp + " --known 'loc(rob1)=main_library_c9'",
       "found 'main_library_c9', expected an element of cell"},
      {kGrasp + " --known 'loc(rob1)'", "expected FLUENT=VALUE"},
      {kGrasp + " --hidden 'loc(tb1)=much'", "found 'much', expected a probability"},
      {kGrasp + " --hidden 'loc(tb1)=main_library:0.5,offce:0.2'",
       "found 'offce', expected an element of place"},
      {kGrasp + " --hidden 'loc(tb2)=0.5'", "says nothing about 'loc(tb2)'"},
      {kGrasp + " --pomdp /nowhere/x", "cannot write '/nowhere/x'"},
      {kOffice + " --state 'loc(rob1)=ofice' --action 'move(rob1, kitchen)'",
       "did you mean 'office'?"}};
  for (const Wrong& wrong : cases)
  {
    const Outcome outcome = run(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, 1) << wrong.arguments;
    expectSays(outcome, {"kr3_zoom: ", wrong.message});
  }
}

}  // namespace
}  // namespace kr3::refinement
