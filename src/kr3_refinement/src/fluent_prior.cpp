// What fluents of the low level alone may be at first.

#include <utility>

#include "prior.hpp"
#include "state_view.hpp"

namespace kr3::refinement
{

std::optional<Distribution> priorOf(const LowLevelDomain& domain, const Models& models,
                                    const std::string& symbol)
{
  const reasoner::FluentDeclaration* fluent = domain.description().findFluent(symbol);
  if (fluent == nullptr || fluent->kind != reasoner::FluentKind::kInertial ||
      domain.highLevel().findFluent(symbol) != nullptr)
  {
    return std::nullopt;
  }
  const auto given = models.priors.find(symbol);
  if (given != models.priors.end())
  {
    return given->second.probabilities;
  }
  if (!fluent->value_sort)
  {
    return std::nullopt;
  }
  const std::vector<std::string>& values =
      domain.description().findSort(*fluent->value_sort)->elements;
  Distribution uniform;
  for (const std::string& value : values)
  {
    uniform[value] = 1.0 / static_cast<double>(values.size());
  }
  return uniform;
}

std::map<std::string, Distribution> priorsOf(const LowLevelDomain& domain, const Models& models,
                                             const std::set<std::string>& constants,
                                             const InitialKnowledge& knowledge)
{
  std::map<std::string, Distribution> result;
  std::set<std::string> known;
  for (const auto& [text, distribution] : knowledge.fine)
  {
    known.insert(normalised(text));
  }
  for (const reasoner::FluentDeclaration& fluent : domain.description().fluents)
  {
    const std::optional<Distribution> prior = priorOf(domain, models, fluent.name);
    std::vector<reasoner::Atom> atoms{{fluent.name, {}, {}}};
    for (const std::string& sort : prior ? fluent.argument_sorts : std::vector<std::string>{})
    {
      std::vector<reasoner::Atom> longer;
      for (const reasoner::Atom& atom : atoms)
      {
        for (const std::string& element : domain.description().findSort(sort)->elements)
        {
          if (constants.count(element) > 0)
          {
            longer.push_back(atom);
            longer.back().arguments.push_back({false, element});
          }
        }
      }
      atoms = std::move(longer);
    }
    for (const reasoner::Atom& atom : prior ? atoms : std::vector<reasoner::Atom>{})
    {
      const std::string name = reasoner::toString(atom);
      if (known.count(name) == 0)
      {
        result.emplace(name, *prior);
      }
    }
  }
  return result;
}

}  // namespace kr3::refinement
