#include "kr3_refinement/low_level_domain.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include <kr3_common/error.hpp>

#include "axiom_lifter.hpp"
#include "problems.hpp"
#include "refinement_check.hpp"

namespace kr3::refinement
{
namespace
{

using reasoner::Description;
using reasoner::FluentDeclaration;
using reasoner::FluentKind;
using reasoner::Literal;
using reasoner::Magnification;
using reasoner::Sort;

bool contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Builds D_L from its three parts and collects what is wrong with them.
class Composer
{
public:
  Composer(const Description& high_level, const Description& refinement, const ComponentMap& map)
    : high_level_(high_level), refinement_(refinement), map_(map)
  {
  }

  Description compose()
  {
    checkRefinement(high_level_, refinement_, map_, problems_);
    problems_.throwIfAny();
    findComponents();
    addSorts();
    addDeclarations();
    addFacts();
    addLaws();
    problems_.throwIfAny();
    return std::move(result_);
  }

  [[nodiscard]] const std::unordered_map<std::string, std::vector<std::string>>& components() const
  {
    return components_;
  }

private:
  void findComponents()
  {
    std::map<std::string, const Magnification*> wholes;
    for (const Magnification& magnification : refinement_.magnifications)
    {
      fine_sorts_.emplace(magnification.coarse, magnification.fine);
      for (const std::string& element : high_level_.findSort(magnification.coarse)->elements)
      {
        wholes.emplace(element, &magnification);
      }
    }
    for (const Component& component : map_.components())
    {
      components_[component.part_of].push_back(component.name);
      elements_[wholes.at(component.part_of)->fine].push_back(component.name);
    }
  }

  [[nodiscard]] std::vector<std::string> fineElements(const Sort& sort) const
  {
    std::vector<std::string> result;
    for (const std::string& element : sort.elements)
    {
      const auto components = components_.find(element);
      if (components == components_.end())
      {
        result.push_back(element);
      }
      else
      {
        result.insert(result.end(), components->second.begin(), components->second.end());
      }
    }
    return result;
  }

  void addSorts()
  {
    result_.sorts = high_level_.sorts;
    for (const Magnification& magnification : refinement_.magnifications)
    {
      result_.sorts.push_back(
          {magnification.fine, elements_[magnification.fine], {}, magnification.position});
    }
    for (const Sort& sort : refinement_.sorts)
    {
      if (result_.findSort(sort.name) == nullptr)
      {
        result_.sorts.push_back(sort);
      }
    }
    // A sort that contains a magnified one gets a fine copy; its coarse self stays for statics.
    for (const Sort& sort : high_level_.sorts)
    {
      const bool magnified = fine_sorts_.count(sort.name) > 0;
      const bool contains_one = std::any_of(
          sort.elements.begin(), sort.elements.end(),
          [this](const std::string& element) { return components_.count(element) > 0; });
      if (contains_one && !magnified)
      {
        std::string name = "fine_" + sort.name;
        while (result_.findSort(name) != nullptr)
        {
          name += "_";
        }
        fine_sorts_.emplace(sort.name, name);
        result_.sorts.push_back({name, fineElements(sort), {}, sort.position});
      }
      if (contains_one)
      {
        magnified_sorts_.insert(sort.name);
      }
    }
  }

  [[nodiscard]] std::string fine(const std::string& sort) const
  {
    const auto entry = fine_sorts_.find(sort);
    return entry == fine_sorts_.end() ? sort : entry->second;
  }

  void addDeclarations()
  {
    for (FluentDeclaration fluent : high_level_.fluents)
    {
      if (fluent.kind != FluentKind::kStatic)
      {
        std::transform(fluent.argument_sorts.begin(), fluent.argument_sorts.end(),
                       fluent.argument_sorts.begin(),
                       [this](const std::string& sort) { return fine(sort); });
        fluent.value_sort =
            fluent.value_sort ? std::optional(fine(*fluent.value_sort)) : std::nullopt;
      }
      result_.fluents.push_back(std::move(fluent));
    }
    for (const Magnification& magnification : refinement_.magnifications)
    {
      if (refinement_.findFluent(magnification.component_static) == nullptr)
      {
        result_.fluents.push_back({magnification.component_static,
                                   FluentKind::kStatic,
                                   {magnification.fine},
                                   magnification.coarse,
                                   magnification.position});
      }
    }
    result_.fluents.insert(result_.fluents.end(), refinement_.fluents.begin(),
                           refinement_.fluents.end());
    for (reasoner::ActionDeclaration action : high_level_.actions)
    {
      if (!action.exogenous)
      {
        std::transform(action.argument_sorts.begin(), action.argument_sorts.end(),
                       action.argument_sorts.begin(),
                       [this](const std::string& sort) { return fine(sort); });
        result_.actions.push_back(std::move(action));
      }
    }
    for (const reasoner::ActionDeclaration& action : refinement_.actions)
    {
      if (!action.exogenous)
      {
        result_.actions.push_back(action);
      }
    }
  }

  void addFacts()
  {
    result_.static_facts = high_level_.static_facts;
    result_.static_facts.insert(result_.static_facts.end(), refinement_.static_facts.begin(),
                                refinement_.static_facts.end());
    for (const Magnification& magnification : refinement_.magnifications)
    {
      for (const Component& component : map_.components())
      {
        if (contains(elements_[magnification.fine], component.name))
        {
          result_.static_facts.push_back(
              {{magnification.component_static, {{false, component.name}}, {}},
               {false, component.part_of},
               true});
        }
      }
      addNeighbors(magnification.fine);
    }
    for (const std::string& fact : map_.facts())
    {
      try
      {
        result_.static_facts.push_back(reasoner::parseGroundLiteral(fact, result_));
      }
      catch (const Error& error)
      {
        problems_.add({map_.source(), 0, 0}, "fact '" + fact + "' of the map: " + error.what());
      }
    }
  }

  /// The facts of the one boolean static over two components that has none yet.
  void addNeighbors(const std::string& fine)
  {
    const FluentDeclaration* relation = nullptr;
    for (const FluentDeclaration& fluent : refinement_.fluents)
    {
      const bool fits = fluent.kind == FluentKind::kStatic && !fluent.value_sort &&
                        fluent.argument_sorts == std::vector<std::string>{fine, fine};
      const bool has_facts =
          std::any_of(refinement_.static_facts.begin(), refinement_.static_facts.end(),
                      [&](const Literal& fact) { return fact.atom.name == fluent.name; });
      if (fits && !has_facts && relation != nullptr)
      {
        problems_.add(fluent.position,
                      "both '" + relation->name + "' and '" + fluent.name +
                          "' could be the map's neighbour relation; give one of them facts in the "
                          "refinement");
        return;
      }
      relation = fits && !has_facts ? &fluent : relation;
    }
    for (std::size_t i = 0; relation != nullptr && i < map_.size(); ++i)
    {
      for (const std::size_t j : map_.neighbors(i))
      {
        const std::string& from = map_.components()[i].name;
        const std::string& to = map_.components()[j].name;
        if (contains(elements_[fine], from) && contains(elements_[fine], to))
        {
          result_.static_facts.push_back(
              {{relation->name, {{false, from}, {false, to}}, {}}, {false, "true"}, true});
        }
      }
    }
  }

  [[nodiscard]] bool isReplaced(const reasoner::CausalLaw& law) const
  {
    const auto effects_of = [](const reasoner::CausalLaw& causal_law) {
      std::set<std::string> fluents;
      for (const reasoner::Outcome& outcome : causal_law.outcomes)
      {
        for (const reasoner::Effect& effect : outcome.effects)
        {
          fluents.insert(effect.fluent.name);
        }
      }
      return fluents;
    };
    const std::set<std::string> own = effects_of(law);
    for (const reasoner::CausalLaw& other : refinement_.causal_laws)
    {
      for (const std::string& fluent : effects_of(other))
      {
        if (other.action.name == law.action.name && own.count(fluent) > 0)
        {
          return true;
        }
      }
    }
    return false;
  }

  [[nodiscard]] bool isAgentAction(const std::string& name) const
  {
    const reasoner::ActionDeclaration* action = high_level_.findAction(name);
    return action != nullptr && !action->exogenous;
  }

  void addLaws()
  {
    AxiomLifter lifter(high_level_, refinement_.magnifications, magnified_sorts_, fine_sorts_,
                       problems_);
    for (const reasoner::CausalLaw& law : high_level_.causal_laws)
    {
      if (isAgentAction(law.action.name) && !isReplaced(law))
      {
        result_.causal_laws.push_back(lifter.lifted(law));
      }
    }
    for (const reasoner::StateConstraint& law : high_level_.constraints)
    {
      result_.constraints.push_back(lifter.lifted(law));
    }
    for (const reasoner::Executability& law : high_level_.executabilities)
    {
      const bool of_agent =
          std::all_of(law.actions.begin(), law.actions.end(), [this](const auto& action) {
            const auto* atom = std::get_if<reasoner::Atom>(&action);
            return atom == nullptr || isAgentAction(atom->name);
          });
      if (of_agent)
      {
        result_.executabilities.push_back(lifter.lifted(law));
      }
    }
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(result_.causal_laws, refinement_.causal_laws);
    append(result_.constraints, refinement_.constraints);
    append(result_.executabilities, refinement_.executabilities);
    append(result_.observations, refinement_.observations);
  }

  const Description& high_level_;
  const Description& refinement_;
  const ComponentMap& map_;
  Description result_;
  std::map<std::string, std::string> fine_sorts_;  // coarse sort -> what replaces it
  std::set<std::string> magnified_sorts_;
  std::map<std::string, std::vector<std::string>> elements_;  // of each fine sort
  std::unordered_map<std::string, std::vector<std::string>> components_;
  Problems problems_;
};

}  // namespace

LowLevelDomain::LowLevelDomain(Description high_level, Description refinement, ComponentMap map)
  : high_level_(std::move(high_level)), refinement_(std::move(refinement)), map_(std::move(map))
{
  Composer composer(high_level_, refinement_, map_);
  description_ = composer.compose();
  components_ = composer.components();
  reasoner::checkDescription(description_);
}

const std::string& LowLevelDomain::coarse(const std::string& constant) const
{
  const std::optional<std::size_t> component = map_.find(constant);
  return component ? map_.components()[*component].part_of : constant;
}

std::vector<std::string> LowLevelDomain::components(const std::string& constant) const
{
  const auto entry = components_.find(constant);
  return entry == components_.end() ? std::vector<std::string>{constant} : entry->second;
}

bool LowLevelDomain::isMagnified(const std::string& constant) const
{
  return components_.count(constant) > 0;
}

reasoner::Literal LowLevelDomain::coarse(const reasoner::Literal& fine) const
{
  reasoner::Literal result = fine;
  for (reasoner::Term& argument : result.atom.arguments)
  {
    argument.name = coarse(argument.name);
  }
  result.value.name = coarse(result.value.name);
  return result;
}

}  // namespace kr3::refinement
