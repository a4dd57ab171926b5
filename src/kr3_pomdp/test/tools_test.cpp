// The command-line tools as a person runs them.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

struct Outcome
{
  int exit_code;
  std::string output;  // stdout, then what came on stderr
};

Outcome run(const std::string& tool, const std::string& arguments)
{
  const std::string command = std::string(KR3_TOOLS_DIR) + "/" + tool + " " + arguments + " 2>&1";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr)
  {
    throw std::runtime_error("cannot run " + command);
  }
  Outcome result{};
  std::array<char, 4096> buffer{};
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe))
  {
    result.output.append(buffer.data(), size);
  }
  result.exit_code = WEXITSTATUS(pclose(pipe));
  return result;
}

std::string contentOf(const std::string& path)
{
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A directory with a flat and a mixed model.
class Tools : public testing::Test
{
protected:
  Tools()
  {
    std::string name = (std::filesystem::temp_directory_path() / "kr3_tools_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
    {
      throw std::runtime_error("no temporary directory");
    }
    directory_ = name;
    std::ofstream tiger(path("tiger.pomdp"));
    writePomdp(tiger, test::tiger());
    std::ofstream mixed(path("mixed.pomdpx"));
    writePomdpx(mixed, test::randomFactored(1));
  }
  ~Tools() override { std::filesystem::remove_all(directory_); }

  [[nodiscard]] std::string path(const std::string& name) const { return directory_ + "/" + name; }
  [[nodiscard]] bool exists(const std::string& name) const
  {
    return std::filesystem::exists(path(name));
  }

private:
  std::string directory_;
};

TEST_F(Tools, SolveEvaluateAndConvertPassAPolicyOn)
{
  for (const std::string model : {"tiger.pomdp", "mixed.pomdpx"})
  {
    const Outcome solved =
        run("kr3_solve", path(model) + " --time 0 --backups 3000 --policy " + path("a.policy"));
    EXPECT_EQ(solved.exit_code, 0) << solved.output;
    EXPECT_NE(solved.output.find("time s"), std::string::npos);
    const std::string with_model = " --model " + path(model);
    EXPECT_EQ(run("kr3_convert", path("a.policy") + " " + path("b.xml") + " --to appl" + with_model)
                  .output,
              "");
    EXPECT_EQ(run("kr3_convert", path("b.xml") + " " + path("c.policy") + with_model).output, "");
    const Outcome ours =
        run("kr3_evaluate", path(model) + " " + path("a.policy") + " --trials 200");
    const Outcome back =
        run("kr3_evaluate", path(model) + " " + path("c.policy") + " --trials 200 --threads 3");
    EXPECT_EQ(ours.exit_code, 0);
    EXPECT_EQ(ours.output, back.output);
    EXPECT_EQ(
        run("kr3_convert", path("a.policy") + " - --to dot" + with_model).output.substr(0, 16),
        "digraph policy {");
    const Outcome direct =
        run("kr3_solve", path(model) + " --time 0 --backups 3000 --quiet --policy " +
                             path("d.xml") + " --format appl");
    EXPECT_EQ(direct.exit_code, 0) << direct.output;
    EXPECT_EQ(contentOf(path("d.xml")), contentOf(path("b.xml")));
  }
}

TEST_F(Tools, SolveOverAHorizonAndExactly)
{
  const std::string tiger = path("tiger.pomdp") + " --horizon 3 --time 0 --policy ";
  const Outcome exact = run("kr3_solve", tiger + path("exact.policy") + " --exact");
  EXPECT_EQ(exact.exit_code, 0) << exact.output;
  EXPECT_EQ(exact.output.substr(0, 22), "optimum in [2.309800, ") << exact.output;
  const Outcome bounds = run("kr3_solve", tiger + path("bounds.policy") + " --backups 500");
  EXPECT_EQ(bounds.exit_code, 0) << bounds.output;
  for (const std::string policy : {"exact.policy", "bounds.policy"})
  {
    const Outcome value =
        run("kr3_evaluate", path("tiger.pomdp") + " " + path(policy) + " --trials 100");
    EXPECT_NE(value.output.find("trials of 3.0 steps"), std::string::npos) << value.output;
    EXPECT_NE(value.output.find("own value: 2.309"), std::string::npos) << value.output;
  }
  EXPECT_NE(run("kr3_solve", path("tiger.pomdp") + " --horizon 3 --format appl").exit_code, 0);
}

TEST_F(Tools, ConvertModels)
{
  EXPECT_EQ(run("kr3_convert", path("tiger.pomdp") + " " + path("t.pomdpx")).output, "");
  EXPECT_EQ(run("kr3_convert", path("t.pomdpx") + " " + path("u.pomdp")).output, "");
  EXPECT_EQ(contentOf(path("u.pomdp")), contentOf(path("tiger.pomdp")));
  EXPECT_EQ(run("kr3_convert", path("mixed.pomdpx") + " " + path("m.pomdpx")).output, "");
  EXPECT_EQ(contentOf(path("m.pomdpx")), contentOf(path("mixed.pomdpx")));
  const Outcome flat = run("kr3_convert", path("mixed.pomdpx") + " " + path("m.pomdp"));
  EXPECT_EQ(flat.exit_code, 1);
  EXPECT_NE(flat.output.find("before its first action"), std::string::npos);
  EXPECT_FALSE(exists("m.pomdp"));
  EXPECT_FALSE(exists("m.pomdp.part"));
}

TEST_F(Tools, TellErrorsWithTheirExitCodes)
{
  EXPECT_EQ(run("kr3_solve", "").exit_code, 2);
  EXPECT_EQ(run("kr3_solve", path("tiger.pomdp") + " --precision -1").exit_code, 2);
  EXPECT_EQ(run("kr3_evaluate", path("tiger.pomdp") + " x --trials 0").exit_code, 2);
  EXPECT_EQ(run("kr3_convert", path("tiger.pomdp") + " x.pomdp --to word").exit_code, 2);
  EXPECT_EQ(run("kr3_solve", "--help").exit_code, 0);
  const Outcome missing = run("kr3_solve", "/no/such/model");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_EQ(missing.output, "cannot open '/no/such/model'\n");
  EXPECT_EQ(run("kr3_solve", "/").output, "cannot read '/'\n");
  // Known before the work: the model is not even read.
  const Outcome unwritable = run("kr3_solve", "/no/such/model --policy /no/such/directory/p");
  EXPECT_EQ(unwritable.output, "cannot write '/no/such/directory/p'\n");
  const Outcome full = run("kr3_solve", path("tiger.pomdp") + " --quiet --policy /dev/full");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.output.find("cannot write '/dev/full'"), std::string::npos);
  std::ofstream(path("bad.pomdp")) << "discount: 2\n";
  EXPECT_EQ(run("kr3_solve", path("bad.pomdp")).output,
            path("bad.pomdp") + ":1:11: found '2', expected a discount in (0, 1]\n");
  EXPECT_EQ(run("kr3_convert", path("tiger.pomdp") + " " + path("x.dot")).exit_code, 1);
  EXPECT_EQ(run("kr3_convert", path("tiger.pomdp") + " " + path("x")).exit_code, 1);
}

}  // namespace
}  // namespace kr3::pomdp
