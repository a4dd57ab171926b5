#include "refinement_check.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

namespace kr3::refinement
{
namespace
{

using reasoner::ActionDeclaration;
using reasoner::CausalLaw;
using reasoner::Description;
using reasoner::FluentDeclaration;
using reasoner::FluentKind;
using reasoner::Magnification;
using reasoner::ObservationLaw;
using reasoner::Sort;

std::string place(const reasoner::SourcePosition& position)
{
  return position.file + ":" + std::to_string(position.line);
}

std::set<std::string> effectsOf(const CausalLaw& law)
{
  std::set<std::string> fluents;
  for (const reasoner::Outcome& outcome : law.outcomes)
  {
    for (const reasoner::Effect& effect : outcome.effects)
    {
      fluents.insert(effect.fluent.name);
    }
  }
  return fluents;
}

bool mentions(const reasoner::Body& body, const std::set<std::string>& fluents)
{
  return std::any_of(body.begin(), body.end(), [&](const reasoner::Condition& condition) {
    const auto* literal = std::get_if<reasoner::Literal>(&condition);
    return literal != nullptr && fluents.count(literal->atom.name) > 0;
  });
}

class Check
{
public:
  Check(const Description& high_level, const Description& refinement, const ComponentMap& map,
        Problems& problems)
    : high_level_(high_level)
    , refinement_(refinement)
    , map_(map)
    , problems_(problems)
    , of_knowledge_(fluentsOfKnowledge({&high_level, &refinement}))
  {
  }

  void run()
  {
    checkSections();
    for (const Magnification& magnification : refinement_.magnifications)
    {
      checkMagnification(magnification);
    }
    checkMap();
    checkReplacedLaws();
    checkChoices();
    checkActions();
    checkObservations();
  }

private:
  /// What belongs to the high level, and would be left out without a word.
  void checkSections()
  {
    for (const reasoner::Default& rule : refinement_.defaults)
    {
      problems_.add(rule.position, "found the default " + rule.name.name +
                                       ", expected none in a refinement: defaults are about the "
                                       "high level; move it to the domain's file");
    }
    for (const reasoner::Preference& rule : refinement_.preferences)
    {
      problems_.add(rule.position,
                    "found a preference between defaults, expected none in a refinement; move it "
                    "to the domain's file");
    }
    for (const reasoner::ActionCost& cost : refinement_.costs)
    {
      problems_.add(cost.position, "found a cost of " + cost.action.name +
                                       ", expected none in a refinement: what low-level actions "
                                       "cost stands in the models file");
    }
    for (const ActionDeclaration& action : refinement_.actions)
    {
      if (action.exogenous)
      {
        problems_.add(action.position,
                      "found the exogenous action " + action.name +
                          ", expected none in a refinement: only diagnosis uses these; move it to "
                          "the domain's file");
      }
    }
  }

  /// The rest is the language's business; a description made in memory has not been there.
  void checkMagnification(const Magnification& own)
  {
    if (high_level_.findSort(own.coarse) == nullptr)
    {
      problems_.add(own.position, "'" + own.coarse + "' is no sort of the high level");
    }
  }

  void checkMap()
  {
    std::map<std::string, const Magnification*> wholes;
    for (const Magnification& magnification : refinement_.magnifications)
    {
      const Sort* sort = high_level_.findSort(magnification.coarse);
      for (const std::string& element :
           sort == nullptr ? std::vector<std::string>{} : sort->elements)
      {
        wholes.emplace(element, &magnification);
      }
    }
    std::vector<std::string> names;
    for (const auto& [element, magnification] : wholes)
    {
      names.push_back(element);
    }
    std::set<std::string> with_parts;
    for (const Component& component : map_.components())
    {
      with_parts.insert(component.part_of);
      if (wholes.count(component.part_of) == 0)
      {
        problems_.add({map_.source(), component.line, 0},
                      "component '" + component.name + "' of the map is part of '" +
                          component.part_of +
                          "', which no magnified sort has; add it to the sort in the domain file, "
                          "or leave the component out" +
                          suggestion(component.part_of, names));
      }
    }
    for (const auto& [element, magnification] : wholes)
    {
      if (with_parts.count(element) == 0)
      {
        problems_.add(magnification->position, "'" + element + "' of sort '" +
                                                   magnification->coarse +
                                                   "' has no components in the map; add some to " +
                                                   map_.source() + ", or take it out of the sort");
      }
    }
    checkComponentNames();
  }

  void checkComponentNames()
  {
    const auto check = [&](const Sort& sort) {
      for (const std::string& element : sort.elements)
      {
        const std::optional<std::size_t> component = map_.find(element);
        if (component)
        {
          problems_.add({map_.source(), map_.components()[*component].line, 0},
                        "'" + element +
                            "' is a component of the map and also an element of sort '" +
                            sort.name + "'; rename one of them");
        }
      }
    };
    std::for_each(high_level_.sorts.begin(), high_level_.sorts.end(), check);
    for (const Sort& sort : refinement_.sorts)
    {
      const bool of_components =
          std::any_of(refinement_.magnifications.begin(), refinement_.magnifications.end(),
                      [&](const Magnification& own) { return own.fine == sort.name; });
      if (!of_components)
      {
        check(sort);
      }
    }
  }

  /// A law of the refinement replaces those of the high level about the same action and fluent;
  /// their other effects must not get lost.
  void checkReplacedLaws()
  {
    std::map<std::string, std::set<std::string>> own;
    std::map<std::string, const CausalLaw*> first;
    for (const CausalLaw& law : refinement_.causal_laws)
    {
      const std::set<std::string> effects = effectsOf(law);
      own[law.action.name].insert(effects.begin(), effects.end());
      first.emplace(law.action.name, &law);
    }
    for (const CausalLaw& law : high_level_.causal_laws)
    {
      const auto entry = own.find(law.action.name);
      const std::set<std::string> effects = effectsOf(law);
      const auto replaced = [&](const std::string& fluent) {
        return entry != own.end() && entry->second.count(fluent) > 0;
      };
      if (std::none_of(effects.begin(), effects.end(), replaced))
      {
        continue;
      }
      for (const std::string& fluent : effects)
      {
        if (!replaced(fluent))
        {
          problems_.add(first.at(law.action.name)->position,
                        "the refinement's laws of " + law.action.name + " replace that of " +
                            place(law.position) + ", but say nothing about its effect on " +
                            fluent + "; add the effect here");
        }
      }
    }
  }

  void checkChoices()
  {
    for (const CausalLaw& law : refinement_.causal_laws)
    {
      for (const reasoner::Outcome& outcome : law.outcomes)
      {
        for (const reasoner::Effect& effect : outcome.effects)
        {
          if (effect.is_choice && mentions(effect.choice, of_knowledge_))
          {
            problems_.add(law.position,
                          "the choice of an effect of " + law.action.name +
                              " rests on what the robot knows, expected statics and fluents of the "
                              "world");
          }
        }
      }
      const std::set<std::string> effects = effectsOf(law);
      const bool on_world = std::any_of(effects.begin(), effects.end(),
                                        [&](const auto& f) { return of_knowledge_.count(f) == 0; });
      if (on_world && mentions(law.body, of_knowledge_))
      {
        problems_.add(law.position, "an effect of " + law.action.name +
                                        " on the world rests on what the robot knows, expected "
                                        "statics and fluents of the world in the body");
      }
    }
  }

  /// Every action of the refinement must do or tell something, and only agent actions have laws.
  void checkActions()
  {
    const auto acts = [](const Description& description, const std::string& action) {
      return std::any_of(description.causal_laws.begin(), description.causal_laws.end(),
                         [&](const CausalLaw& law) { return law.action.name == action; });
    };
    const auto tells = [&](const std::string& action) {
      return std::any_of(refinement_.observations.begin(), refinement_.observations.end(),
                         [&](const ObservationLaw& law) { return law.action.name == action; });
    };
    for (const ActionDeclaration& action : refinement_.actions)
    {
      if (!action.exogenous && !acts(refinement_, action.name) && !tells(action.name))
      {
        problems_.add(
            action.position,
            "the action " + action.name +
                " has no effect and tells nothing, expected a law 'causes' or 'observes'");
      }
    }
    const auto checkExogenous = [&](const reasoner::Atom& atom, const auto& position) {
      const ActionDeclaration* action = high_level_.findAction(atom.name);
      if (action != nullptr && action->exogenous)
      {
        problems_.add(position, "found a law of the exogenous action " + atom.name + " (" +
                                    place(action->position) +
                                    "), expected none in a refinement: what happens without the "
                                    "robot is the high level's business");
      }
    };
    for (const CausalLaw& law : refinement_.causal_laws)
    {
      checkExogenous(law.action, law.position);
    }
    for (const ObservationLaw& law : refinement_.observations)
    {
      checkExogenous(law.action, law.position);
    }
  }

  void checkObservations()
  {
    for (const ObservationLaw& law : refinement_.observations)
    {
      const FluentDeclaration* fluent = refinement_.findFluent(law.fluent.name);
      fluent = fluent == nullptr ? high_level_.findFluent(law.fluent.name) : fluent;
      const std::string what = law.action.name + " observes " + law.fluent.name;
      // A static that no file declares is the one that relates components.
      if (fluent == nullptr || fluent->kind == FluentKind::kStatic)
      {
        problems_.add(law.position, what + ", a static that everybody knows; observe a fluent");
      }
      else if (of_knowledge_.count(fluent->name) > 0)
      {
        problems_.add(law.position, what +
                                        ", which is about what the robot knows; observe a fluent "
                                        "of the world, from which it follows");
      }
      checkBound(law, what);
    }
  }

  void checkBound(const ObservationLaw& law, const std::string& what)
  {
    std::vector<reasoner::Term> used = law.fluent.arguments;
    if (law.value)
    {
      used.push_back(*law.value);
    }
    for (const reasoner::Term& term : used)
    {
      const auto& arguments = law.action.arguments;
      if (term.is_variable &&
          std::find(arguments.begin(), arguments.end(), term) == arguments.end())
      {
        problems_.add(law.position, what + " with the variable " + term.name +
                                        ", which is no argument of the action; add it to the "
                                        "action, or leave the value out to observe which it is");
      }
    }
  }

  const Description& high_level_;
  const Description& refinement_;
  const ComponentMap& map_;
  Problems& problems_;
  std::set<std::string> of_knowledge_;
};

}  // namespace

void checkRefinement(const Description& high_level, const Description& refinement,
                     const ComponentMap& map, Problems& problems)
{
  Check(high_level, refinement, map, problems).run();
}

std::set<std::string> fluentsOfKnowledge(const std::vector<const Description*>& descriptions)
{
  std::set<std::string> found;
  std::set<std::string> defined;
  for (const Description* description : descriptions)
  {
    for (const FluentDeclaration& fluent : description->fluents)
    {
      if (fluent.kind == FluentKind::kKnowledge)
      {
        found.insert(fluent.name);
      }
      else if (fluent.kind == FluentKind::kDefined)
      {
        defined.insert(fluent.name);
      }
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const Description* description : descriptions)
    {
      for (const reasoner::StateConstraint& law : description->constraints)
      {
        changed = (law.head && defined.count(law.head->atom.name) > 0 &&
                   mentions(law.body, found) && found.insert(law.head->atom.name).second) ||
                  changed;
      }
    }
  }
  return found;
}

}  // namespace kr3::refinement
