#include "kr3_executive/domain_files.hpp"

#include <filesystem>
#include <utility>

#include "yaml_reader.hpp"

namespace kr3::executive
{
namespace
{

DomainFile fileAt(const std::string& path)
{
  return {std::filesystem::path(path).filename().string(), readTextFile(path)};
}

}  // namespace

DomainFiles readDomainFiles(const std::string& domain, const std::string& refinement,
                            const std::string& models, const std::string& bindings,
                            refinement::ComponentMap map)
{
  return {fileAt(domain), fileAt(refinement), fileAt(models), fileAt(bindings), std::move(map)};
}

LoadedDomain load(const DomainFiles& files)
{
  const auto high_level = reasoner::parseDescription(files.domain.text, files.domain.name);
  const auto refined =
      reasoner::parseRefinement(files.refinement.text, files.refinement.name, high_level);
  LoadedDomain loaded;
  loaded.domain = std::make_unique<refinement::LowLevelDomain>(high_level, refined, files.map);
  loaded.models = refinement::parseModels(files.models.text, files.models.name, *loaded.domain);
  loaded.bindings =
      Bindings::parse(files.bindings.text, files.bindings.name, loaded.domain->description());
  return loaded;
}

}  // namespace kr3::executive
