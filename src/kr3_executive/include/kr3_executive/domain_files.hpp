#pragma once

#include <memory>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>
#include <kr3_refinement/component_map.hpp>
#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/bindings.hpp"

namespace kr3::executive
{

/// A file of a domain as it was read.
struct DomainFile
{
  std::string name;  ///< for messages: "domain.kr3"
  std::string text;
};

/// All that a mission's decisions depend on besides its inputs: the texts of a domain's files and
/// the components of the map.
struct DomainFiles
{
  DomainFile domain;
  DomainFile refinement;
  DomainFile models;
  DomainFile bindings;
  refinement::ComponentMap map;
};

/// Reads the texts; their content is not checked.
/// @throws Unavailable  a file cannot be read
[[nodiscard]] DomainFiles readDomainFiles(const std::string& domain, const std::string& refinement,
                                          const std::string& models, const std::string& bindings,
                                          refinement::ComponentMap map);

/// A domain made from its texts, as a mission needs it.
struct LoadedDomain
{
  std::unique_ptr<refinement::LowLevelDomain> domain;
  refinement::Models models;
  Bindings bindings;
};

/// @throws InvalidArgument  a text is wrong; one line for each problem
[[nodiscard]] LoadedDomain load(const DomainFiles& files);

/// The same once the descriptions are read. A refinement or a map that does not fit hides nothing
/// that is wrong with the others.
[[nodiscard]] LoadedDomain load(const reasoner::Description& high_level,
                                const reasoner::Description& refined,
                                const refinement::ComponentMap& map, const DomainFile& models,
                                const DomainFile& bindings,
                                const refinement::ModelsOptions& numbers = {});

}  // namespace kr3::executive
