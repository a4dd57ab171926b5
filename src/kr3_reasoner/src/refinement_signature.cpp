#include "refinement_signature.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "diagnostics.hpp"

namespace kr3::reasoner
{

namespace
{

bool contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string place(const SourcePosition& position)
{
  return position.file + ":" + std::to_string(position.line);
}

class Signature
{
public:
  Signature(const Description& refinement, const Description& base,
            std::vector<Diagnostic>& problems)
    : refinement_(refinement), base_(base), problems_(problems), merged_(refinement)
  {
  }

  Description make()
  {
    dropDeclaredAgain();
    for (const Magnification& magnification : refinement_.magnifications)
    {
      if (isSound(magnification))
      {
        accepted_.push_back(&magnification);
      }
    }
    merged_.magnifications.clear();
    merged_.sorts.insert(merged_.sorts.end(), base_.sorts.begin(), base_.sorts.end());
    std::for_each(accepted_.begin(), accepted_.end(), [this](const auto* m) { addFineSort(*m); });
    addContainingSorts();
    addBase();
    return std::move(merged_);
  }

private:
  void report(const SourcePosition& position, const std::string& message)
  {
    problems_.push_back({position, message});
  }

  /// Where the base declares a name, or nullptr.
  [[nodiscard]] const SourcePosition* declaredInBase(const std::string& name) const
  {
    if (const Sort* sort = base_.findSort(name))
    {
      return &sort->position;
    }
    if (const FluentDeclaration* fluent = base_.findFluent(name))
    {
      return &fluent->position;
    }
    const ActionDeclaration* action = base_.findAction(name);
    return action == nullptr ? nullptr : &action->position;
  }

  void dropDeclaredAgain()
  {
    const auto drop = [this](auto& declarations) {
      const auto again = [this](const auto& declaration) {
        const SourcePosition* first = declaredInBase(declaration.name);
        if (first != nullptr)
        {
          report(declaration.position,
                 "'" + declaration.name + "' is a name of the high level (" + place(*first) +
                     "), expected a new name: what the high level declares is used here without "
                     "declaring it again");
        }
        return first != nullptr;
      };
      declarations.erase(std::remove_if(declarations.begin(), declarations.end(), again),
                         declarations.end());
    };
    drop(merged_.sorts);
    drop(merged_.fluents);
    drop(merged_.actions);
  }

  [[nodiscard]] bool isSound(const Magnification& own)
  {
    const std::size_t before = problems_.size();
    const Sort* coarse = base_.findSort(own.coarse);
    if (coarse == nullptr)
    {
      std::vector<std::string> names;
      std::transform(base_.sorts.begin(), base_.sorts.end(), std::back_inserter(names),
                     [](const Sort& sort) { return sort.name; });
      const bool is_fine =
          std::any_of(refinement_.magnifications.begin(), refinement_.magnifications.end(),
                      [&](const Magnification& other) { return other.fine == own.coarse; });
      report(own.position,
             is_fine ? "'" + own.coarse + "' is a sort of components, expected a " +
                           "sort of the high level: components have no components"
                     : "unknown sort '" + own.coarse + "'" + suggestion(own.coarse, names));
      return false;
    }
    for (const Magnification* first : accepted_)
    {
      checkPair(*first, own, *coarse);
    }
    checkFineSort(own);
    checkComponentStatic(own);
    return problems_.size() == before;
  }

  void checkPair(const Magnification& first, const Magnification& own, const Sort& coarse)
  {
    const std::string before = ", as in line " + std::to_string(first.position.line);
    const Sort* other = base_.findSort(first.coarse);
    if (first.coarse == own.coarse)
    {
      report(own.position, "the sort '" + own.coarse + "' is magnified twice" + before +
                               "; leave one of the two");
      return;
    }
    const auto shared = std::find_if(
        coarse.elements.begin(), coarse.elements.end(),
        [&](const std::string& element) { return contains(other->elements, element); });
    if (shared != coarse.elements.end())
    {
      report(own.position, "'" + *shared + "' is magnified twice" + before + " by the sort '" +
                               first.coarse +
                               "'; magnify disjoint sorts, or the sort that contains both");
    }
    if (first.fine == own.fine)
    {
      report(own.position, "the components of '" + own.coarse + "' are named '" + own.fine + "'" +
                               before + ", expected a sort of components of its own");
    }
    if (first.component_static == own.component_static)
    {
      report(own.position, "'" + own.component_static + "' relates the components of '" +
                               own.coarse + "'" + before + ", expected a static of its own");
    }
  }

  void checkFineSort(const Magnification& own)
  {
    const SourcePosition* high = declaredInBase(own.fine);
    const Sort* low = refinement_.findSort(own.fine);
    if (high != nullptr)
    {
      report(own.position, "'" + own.coarse + "' is magnified into '" + own.fine +
                               "', a name of the high level (" + place(*high) +
                               "), expected a new name for the components");
    }
    else if (low != nullptr)
    {
      report(low->position, "the sort '" + own.fine +
                                "' is declared here, but its elements are the components that the "
                                "map lists; leave the declaration out");
    }
  }

  void checkComponentStatic(const Magnification& own)
  {
    const std::string& name = own.component_static;
    const SourcePosition* high = declaredInBase(name);
    if (high != nullptr)
    {
      report(own.position, "'" + name + "' is a name of the high level (" + place(*high) +
                               "), expected a new one for the static that relates the components");
      return;
    }
    const FluentDeclaration* low = refinement_.findFluent(name);
    const bool fits =
        low == nullptr || (low->kind == FluentKind::kStatic && low->value_sort == own.coarse &&
                           low->argument_sorts == std::vector<std::string>{own.fine});
    if (!fits)
    {
      report(low->position, "'" + name + "' relates components to their wholes, expected the " +
                                "static '" + name + "(" + own.fine + ") : " + own.coarse +
                                "', or no declaration");
    }
    for (const Literal& fact : refinement_.static_facts)
    {
      if (fact.atom.name == name)
      {
        report(fact.atom.position, "found a fact about '" + name +
                                       "', expected it in the map: which component is part of what "
                                       "comes from there; leave it out");
      }
    }
  }

  void addFineSort(const Magnification& magnification)
  {
    fine_of_[magnification.coarse] = magnification.fine;
    merged_.sorts.push_back(
        {magnification.fine, {"some_" + magnification.fine}, {}, magnification.position});
    if (merged_.findFluent(magnification.component_static) == nullptr)
    {
      merged_.fluents.push_back({magnification.component_static,
                                 FluentKind::kStatic,
                                 {magnification.fine},
                                 magnification.coarse,
                                 magnification.position});
    }
  }

  void addContainingSorts()
  {
    std::map<std::string, std::string> component_of;  // magnified element -> its placeholder
    for (const Magnification* magnification : accepted_)
    {
      for (const std::string& element : base_.findSort(magnification->coarse)->elements)
      {
        component_of.emplace(element, "some_" + magnification->fine);
      }
    }
    for (const Sort& sort : base_.sorts)
    {
      Sort fine{"fine_" + sort.name, {}, {}, sort.position};
      bool has_components = false;
      for (const std::string& element : sort.elements)
      {
        const auto component = component_of.find(element);
        has_components = has_components || component != component_of.end();
        const std::string& own = component == component_of.end() ? element : component->second;
        if (!contains(fine.elements, own))
        {
          fine.elements.push_back(own);
        }
      }
      if (!has_components || fine_of_.count(sort.name) > 0)
      {
        continue;
      }
      while (merged_.findSort(fine.name) != nullptr)
      {
        fine.name += "_";
      }
      fine_of_.emplace(sort.name, fine.name);
      merged_.sorts.push_back(std::move(fine));
    }
  }

  void addBase()
  {
    const auto refine = [this](std::string& sort) {
      const auto found = fine_of_.find(sort);
      sort = found == fine_of_.end() ? sort : found->second;
    };
    for (FluentDeclaration fluent : base_.fluents)
    {
      if (fluent.kind != FluentKind::kStatic)
      {
        std::for_each(fluent.argument_sorts.begin(), fluent.argument_sorts.end(), refine);
        if (fluent.value_sort)
        {
          refine(*fluent.value_sort);
        }
      }
      merged_.fluents.push_back(std::move(fluent));
    }
    for (ActionDeclaration action : base_.actions)
    {
      std::for_each(action.argument_sorts.begin(), action.argument_sorts.end(), refine);
      merged_.actions.push_back(std::move(action));
    }
  }

  const Description& refinement_;
  const Description& base_;
  std::vector<Diagnostic>& problems_;
  Description merged_;
  std::vector<const Magnification*> accepted_;
  std::map<std::string, std::string> fine_of_;  // sort of the base -> what replaces it
};

}  // namespace

Description fineSignature(const Description& refinement, const Description& base,
                          std::vector<Diagnostic>& problems)
{
  return Signature(refinement, base, problems).make();
}

}  // namespace kr3::reasoner
