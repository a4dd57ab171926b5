// docs/refinement.md: its files are read as they stand there.

#include <map>
#include <sstream>
#include <string>

#include "fixtures.hpp"
#include "kr3_refinement/coupling_check.hpp"

namespace kr3::refinement
{
namespace
{

/// The first block of code after each "File `name`".
std::map<std::string, std::string> filesOf(const std::string& page)
{
  std::map<std::string, std::string> files;
  std::istringstream lines(page);
  std::string file;
  bool inside = false;
  for (std::string line; std::getline(lines, line);)
  {
    if (!inside && line.rfind("File `", 0) == 0)
    {
      file = line.substr(6, line.find('`', 6) - 6);
    }
    else if (line.rfind("```", 0) == 0)
    {
      inside = !inside && !file.empty();
      file = inside ? file : "";
    }
    else if (inside)
    {
      files[file] += line + "\n";
    }
  }
  return files;
}

TEST(RefinementPage, HasFilesThatFitTogether)
{
  std::map<std::string, std::string> files =
      filesOf(test::textOf(std::string(KR3_DOMAINS_DIR) + "/../docs/refinement.md"));
  for (const char* file : {"domain.kr3", "refinement.kr3", "map.yaml", "models.yaml",
                           "bindings.yaml", "scenario.yaml"})
  {
    EXPECT_EQ(files.count(file), 1U) << file;
  }
  const std::string map = ::testing::TempDir() + "refinement_page_map.yaml";
  std::ofstream(map) << files["map.yaml"];
  const LowLevelDomain domain =
      test::composed(files["domain.kr3"], files["refinement.kr3"], readComponentMap(map));
  const Models models = parseModels(files["models.yaml"], "models.yaml", domain);
  EXPECT_EQ(handWritten(models).size(), 4U);
  const CouplingReport report = checkCoupling(domain);
  EXPECT_TRUE(report.passed()) << toString(report);
  EXPECT_GT(report.num_transitions, 0U);
}

}  // namespace
}  // namespace kr3::refinement
