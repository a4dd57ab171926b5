#include "kr3_refinement/observation_theory.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{
namespace
{

using reasoner::Atom;
using reasoner::Body;
using reasoner::Description;
using reasoner::FluentDeclaration;
using reasoner::FluentKind;
using reasoner::Literal;
using reasoner::Magnification;
using reasoner::Term;

const Term kTrue{false, "true"};
const Term kFalse{false, "false"};

/// A term of a fluent as its whole, and what says so. A term of a mixed sort has several readings.
struct Reading
{
  Body conditions;
  Term whole;
};

class Theory
{
public:
  explicit Theory(const LowLevelDomain& domain) : domain_(domain), result_(domain.description()) {}

  Description make()
  {
    std::set<std::string> done;
    for (const reasoner::ObservationLaw& law : domain_.description().observations)
    {
      if (done.insert(law.fluent.name).second)
      {
        add(*domain_.description().findFluent(law.fluent.name));
      }
      addTest(law);
    }
    reasoner::checkDescription(result_);
    return std::move(result_);
  }

private:
  /// Declarations and definitions for one fluent.
  void add(const FluentDeclaration& fluent)
  {
    const ObservationFluents names = observationFluents(fluent.name);
    std::vector<std::string> fine = fluent.argument_sorts;
    if (fluent.value_sort)
    {
      fine.push_back(*fluent.value_sort);
    }
    std::vector<std::string> coarse;
    std::transform(fine.begin(), fine.end(), std::back_inserter(coarse),
                   [this](const std::string& sort) { return coarseSort(sort); });
    declare(names.tested, FluentKind::kKnowledge, fine);
    declare(names.observed, FluentKind::kDefined, fine);
    for (const std::string& name : {names.found, names.may_discover, names.failure})
    {
      declare(name, FluentKind::kDefined, coarse);
    }
    const std::vector<Term> terms = variables(fine.size(), "X");
    Literal holds{{fluent.name, terms, {}}, kTrue, true};
    if (fluent.value_sort)
    {
      holds.value = terms.back();
      holds.atom.arguments.pop_back();
    }
    define({names.observed, terms, {}}, {literal(names.tested, terms, true), holds});
    for (const std::vector<Reading>& readings : readingsOf(fine))
    {
      addCoarse(names, terms, readings);
    }
    const std::vector<Term> wholes = variables(fine.size(), "W");
    define({names.failure, wholes, {}},
           {literal(names.found, wholes, false), literal(names.may_discover, wholes, false)});
  }

  void addCoarse(const ObservationFluents& names, const std::vector<Term>& terms,
                 const std::vector<Reading>& readings)
  {
    std::vector<Term> wholes;
    Body parts;
    for (const Reading& reading : readings)
    {
      wholes.push_back(reading.whole);
      parts.insert(parts.end(), reading.conditions.begin(), reading.conditions.end());
    }
    Body found{literal(names.observed, terms, true)};
    found.insert(found.end(), parts.begin(), parts.end());
    define({names.found, wholes, {}}, std::move(found));
    Body open{literal(names.found, wholes, false), literal(names.tested, terms, false)};
    open.insert(open.end(), parts.begin(), parts.end());
    define({names.may_discover, wholes, {}}, std::move(open));
  }

  void addTest(const reasoner::ObservationLaw& law)
  {
    const FluentDeclaration& fluent = *domain_.description().findFluent(law.fluent.name);
    reasoner::CausalLaw test{law.action, {}, {}, law.position};
    Atom tested{observationFluents(fluent.name).tested, law.fluent.arguments, law.position};
    if (fluent.value_sort)
    {
      const Term value = law.value ? *law.value : Term{true, "Any_value"};
      tested.arguments.push_back(value);
      if (!law.value)
      {
        test.body.emplace_back(reasoner::Membership{*fluent.value_sort, value, false, {}});
      }
    }
    test.outcomes = {{"", {{tested, kTrue, false, {}}}}};
    result_.causal_laws.push_back(std::move(test));
  }

  void declare(const std::string& name, FluentKind kind, const std::vector<std::string>& sorts)
  {
    if (result_.findFluent(name) != nullptr || result_.findAction(name) != nullptr ||
        result_.findSort(name) != nullptr)
    {
      throw InvalidArgument("'" + name +
                            "' is declared in the domain, but the theory of observations defines "
                            "it; rename it in the domain");
    }
    result_.fluents.push_back({name, kind, sorts, std::nullopt, {}});
  }

  void define(Atom head, Body body)
  {
    result_.constraints.push_back({Literal{std::move(head), kTrue, true}, std::move(body), {}});
  }

  [[nodiscard]] static Literal literal(const std::string& fluent, const std::vector<Term>& terms,
                                       bool value)
  {
    return {{fluent, terms, {}}, value ? kTrue : kFalse, true};
  }

  [[nodiscard]] static std::vector<Term> variables(std::size_t count, const std::string& name)
  {
    std::vector<Term> result;
    for (std::size_t i = 0; i < count; ++i)
    {
      result.push_back({true, name + std::to_string(i + 1)});
    }
    return result;
  }

  [[nodiscard]] std::set<std::string> elementsOf(const std::string& sort) const
  {
    const std::vector<std::string>& elements = domain_.description().findSort(sort)->elements;
    return {elements.begin(), elements.end()};
  }

  /// The sort with the wholes of another's components.
  std::string coarseSort(const std::string& sort)
  {
    std::set<std::string> wholes;
    bool same = true;
    for (const std::string& element : elementsOf(sort))
    {
      wholes.insert(domain_.coarse(element));
      same = same && domain_.coarse(element) == element;
    }
    if (same)
    {
      return sort;
    }
    for (const reasoner::Sort& candidate : domain_.highLevel().sorts)
    {
      if (elementsOf(candidate.name) == wholes)
      {
        return candidate.name;
      }
    }
    const std::string name = "wholes_of_" + sort;
    if (result_.findSort(name) == nullptr)
    {
      result_.sorts.push_back({name, {wholes.begin(), wholes.end()}, {}, {}});
    }
    return name;
  }

  /// Every way to read the terms of a fluent as wholes.
  [[nodiscard]] std::vector<std::vector<Reading>> readingsOf(
      const std::vector<std::string>& sorts) const
  {
    std::vector<std::vector<Reading>> result{{}};
    for (std::size_t i = 0; i < sorts.size(); ++i)
    {
      std::vector<std::vector<Reading>> longer;
      for (const std::vector<Reading>& first : result)
      {
        for (const Reading& next : readingsOf(sorts[i], std::to_string(i + 1)))
        {
          longer.push_back(first);
          longer.back().push_back(next);
        }
      }
      result = std::move(longer);
    }
    return result;
  }

  [[nodiscard]] std::vector<Reading> readingsOf(const std::string& sort,
                                                const std::string& number) const
  {
    const std::set<std::string> elements = elementsOf(sort);
    const Term term{true, "X" + number};
    std::vector<Reading> result;
    Reading itself{{}, term};
    std::size_t components = 0;
    for (const Magnification& magnification : domain_.refinement().magnifications)
    {
      const std::set<std::string> fine = elementsOf(magnification.fine);
      const auto shared = static_cast<std::size_t>(
          std::count_if(fine.begin(), fine.end(),
                        [&](const std::string& element) { return elements.count(element) > 0; }));
      if (shared > 0)
      {
        const Term whole{true, "W" + number};
        result.push_back(
            {{Literal{{magnification.component_static, {term}, {}}, whole, true}}, whole});
        itself.conditions.emplace_back(reasoner::Membership{magnification.fine, term, true, {}});
        components += shared;
      }
    }
    if (components < elements.size())
    {
      result.push_back(std::move(itself));
    }
    return result;
  }

  const LowLevelDomain& domain_;
  Description result_;
};

}  // namespace

ObservationFluents observationFluents(const std::string& fluent)
{
  return {"tested_" + fluent, "observed_" + fluent, "found_" + fluent, "may_discover_" + fluent,
          "failure_" + fluent};
}

Description withObservationTheory(const LowLevelDomain& domain)
{
  return Theory(domain).make();
}

std::vector<Literal> freshKnowledge(const Description& description)
{
  std::vector<Literal> result;
  for (const FluentDeclaration& fluent : description.fluents)
  {
    if (fluent.kind != FluentKind::kKnowledge)
    {
      continue;
    }
    std::vector<Atom> atoms{{fluent.name, {}, {}}};
    for (const std::string& sort : fluent.argument_sorts)
    {
      std::vector<Atom> longer;
      for (const Atom& atom : atoms)
      {
        for (const std::string& element : description.findSort(sort)->elements)
        {
          longer.push_back(atom);
          longer.back().arguments.push_back({false, element});
        }
      }
      atoms = std::move(longer);
    }
    std::transform(atoms.begin(), atoms.end(), std::back_inserter(result), [](const Atom& atom) {
      return Literal{atom, kFalse, true};
    });
  }
  return result;
}

}  // namespace kr3::refinement
