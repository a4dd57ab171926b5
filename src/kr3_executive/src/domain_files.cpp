#include "kr3_executive/domain_files.hpp"

#include <filesystem>
#include <utility>

#include <kr3_refinement/low_level_files.hpp>

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

LoadedDomain load(const reasoner::Description& high_level, const reasoner::Description& refined,
                  const refinement::ComponentMap& map, const DomainFile& models,
                  const DomainFile& bindings, const refinement::ModelsOptions& numbers)
{
  LoadedDomain loaded;
  refinement::Refusals refusals;
  refusals.attempt([&] {
    loaded.domain = std::make_unique<refinement::LowLevelDomain>(high_level, refined, map);
  });
  const auto names = loaded.domain ? loaded.domain->description()
                                   : refinement::namesOfLowLevel(high_level, refined, map);
  refusals.attempt([&] {
    loaded.models = loaded.domain
                        ? refinement::parseModels(models.text, models.name, *loaded.domain, numbers)
                        : refinement::parseModels(models.text, models.name, names, numbers);
  });
  refusals.attempt([&] { loaded.bindings = Bindings::parse(bindings.text, bindings.name, names); });
  refusals.throwIfAny();
  return loaded;
}

LoadedDomain load(const DomainFiles& files)
{
  const auto high_level = reasoner::parseDescription(files.domain.text, files.domain.name);
  const auto refined =
      refinement::parseRefinementText(files.refinement.text, files.refinement.name, high_level);
  return load(high_level, refined, files.map, files.models, files.bindings);
}

}  // namespace kr3::executive
