#pragma once

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/zoom.hpp"

namespace kr3::refinement::test
{

inline std::string domainFile(const std::string& domain, const std::string& file)
{
  return std::string(KR3_DOMAINS_DIR) + "/" + domain + "/" + file;
}

inline std::string textOf(const std::string& path)
{
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline LowLevelDomain composed(const std::string& high_level, const std::string& refinement,
                               const ComponentMap& map)
{
  const reasoner::Description description = reasoner::parseDescription(high_level, "domain.kr3");
  return {description, reasoner::parseRefinement(refinement, "refinement.kr3", description), map};
}

/// A domain of the repository with its models.
struct Domain
{
  LowLevelDomain low_level;
  Models models;

  [[nodiscard]] std::vector<reasoner::Literal> state(const std::vector<std::string>& literals) const
  {
    std::vector<reasoner::Literal> result;
    for (const std::string& literal : literals)
    {
      result.push_back(reasoner::parseGroundLiteral(literal, low_level.highLevel()));
    }
    return result;
  }
  [[nodiscard]] reasoner::Atom action(const std::string& text) const
  {
    return reasoner::parseGroundAction(text, low_level.highLevel());
  }
  [[nodiscard]] Zoom zoomOn(const std::string& text, const std::vector<std::string>& literals) const
  {
    return zoom(low_level, state(literals), action(text));
  }
  [[nodiscard]] PomdpTask task(const std::string& text, const std::vector<std::string>& literals,
                               const InitialKnowledge& knowledge) const
  {
    return generatePomdp(low_level, models, zoomOn(text, literals), knowledge);
  }
};

inline Domain domainOf(const std::string& name, const ComponentMap& map)
{
  LowLevelDomain low_level = composed(textOf(domainFile(name, "domain.kr3")),
                                      textOf(domainFile(name, "refinement.kr3")), map);
  Models models = readModels(domainFile(name, "models.yaml"), low_level.description());
  return {std::move(low_level), std::move(models)};
}

inline Domain office(std::size_t cells_per_place = 4)
{
  return domainOf("office", gridMap({"office", "main_library", "aux_library", "kitchen",
                                     "study_corner", "corridor"},
                                    cells_per_place, 1.0));
}

inline Domain workbench()
{
  return domainOf("workbench", readComponentMap(domainFile("workbench", "map.yaml")));
}

/// Runs something that must throw a kr3::Error of a code, and checks that its message has a part.
template <typename Run>
void expectError(ErrorCode code, const std::string& part, Run run)
{
  try
  {
    run();
    FAIL() << "expected an error that says: " << part;
  }
  catch (const Error& error)
  {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace kr3::refinement::test
