#include "prior.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <kr3_common/error.hpp>

#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

bool isOutside(const std::string& value, const Zoom& zoom)
{
  return value != "true" && value != "false" && zoom.constants.count(value) == 0;
}

void checkDistribution(const std::string& fluent, const Distribution& distribution, bool may_lack)
{
  double total = 0.0;
  for (const auto& [value, probability] : distribution)
  {
    if (!(probability >= 0.0 && probability <= 1.0 + 1e-9))
    {
      throw InvalidArgument("initial knowledge of " + fluent + ": probability " +
                            std::to_string(probability) + " of '" + value +
                            "', expected one in [0, 1]");
    }
    total += probability;
  }
  if (total > 1.0 + 1e-6 || (!may_lack && total < 1.0 - 1e-6))
  {
    throw InvalidArgument("initial knowledge of " + fluent + ": the probabilities sum to " +
                          std::to_string(total) +
                          (may_lack ? ", expected at most 1" : ", expected 1"));
  }
}

/// Says how likely each state is by what is known of one fluent, fine or coarse.
class Factor
{
public:
  /// @param strict  a value that no state has is an error, or else just impossible
  Factor(std::string name, std::vector<std::size_t> fluents, bool boolean, bool coarse,
         Distribution distribution, bool strict = true)
    : name_(std::move(name))
    , fluents_(std::move(fluents))
    , boolean_(boolean)
    , coarse_(coarse)
    , distribution_(std::move(distribution))
    , strict_(strict)
  {
  }

  /// Probability of a coarse value is shared by the fine assignments that have it: count them
  /// first.
  void count(const LowLevelDomain& domain, const Semantics& semantics,
             const std::vector<Values>& states)
  {
    std::map<std::string, std::set<std::vector<int>>> assignments;
    for (const Values& state : states)
    {
      std::vector<int> assignment;
      std::transform(fluents_.begin(), fluents_.end(), std::back_inserter(assignment),
                     [&](std::size_t fluent) { return state[fluent]; });
      assignments[value(domain, semantics, state)].insert(std::move(assignment));
    }
    for (const auto& [value, fine] : assignments)
    {
      share_[value] = 1.0 / static_cast<double>(fine.size());
    }
    for (const auto& [value, probability] : distribution_)
    {
      if (strict_ && probability > 0.0 && share_.count(value) == 0)
      {
        throw InvalidArgument("initial knowledge of " + name_ +
                              ": no state of the zoom has the value '" + value + "'");
      }
    }
  }

  [[nodiscard]] double weight(const LowLevelDomain& domain, const Semantics& semantics,
                              const Values& state) const
  {
    const std::string own = value(domain, semantics, state);
    const auto probability = distribution_.find(own);
    return probability == distribution_.end() ? 0.0 : probability->second * share_.at(own);
  }

private:
  [[nodiscard]] std::string value(const LowLevelDomain& domain, const Semantics& semantics,
                                  const Values& state) const
  {
    std::vector<std::string> values;
    for (const std::size_t fluent : fluents_)
    {
      const std::string& fine = semantics.vocabulary().name(state[fluent]);
      values.push_back(coarse_ ? domain.coarse(fine) : fine);
    }
    return coarseValue(values, boolean_);
  }

  std::string name_;
  std::vector<std::size_t> fluents_;
  bool boolean_;
  bool coarse_;
  Distribution distribution_;
  bool strict_;
  std::map<std::string, double> share_;
};

class Prior
{
public:
  Prior(const LowLevelDomain& domain, const Zoom& zoom, const InitialKnowledge& knowledge,
        const std::map<std::string, Distribution>& priors, const Semantics& semantics)
    : domain_(domain)
    , zoom_(zoom)
    , semantics_(semantics)
    , coarse_fluents_(coarseFluents(domain, semantics))
  {
    for (const auto& [text, distribution] : knowledge.fine)
    {
      addFine(normalised(text), distribution);
    }
    for (const auto& [text, distribution] : knowledge.coarse)
    {
      addCoarse(normalised(text), distribution);
    }
    for (const auto& [name, distribution] : priors)
    {
      addPrior(name, distribution);
    }
    for (const auto& [name, fluents] : coarse_fluents_)
    {
      addFromStart(name, fluents);
    }
  }

  [[nodiscard]] std::vector<double> weights(const std::vector<Values>& states)
  {
    std::vector<double> result(states.size(), 1.0);
    for (Factor& factor : factors_)
    {
      factor.count(domain_, semantics_, states);
      for (std::size_t i = 0; i < states.size(); ++i)
      {
        result[i] *= result[i] == 0.0 ? 0.0 : factor.weight(domain_, semantics_, states[i]);
      }
    }
    const double total = std::accumulate(result.begin(), result.end(), 0.0);
    if (!(total > 0.0))
    {
      throw FailedPrecondition("no low-level state of " + zoom_.action +
                               " fits the initial knowledge");
    }
    for (double& weight : result)
    {
      weight /= total;
    }
    return result;
  }

private:
  [[nodiscard]] bool isBoolean(std::size_t fluent) const
  {
    return semantics_.signature().symbols()[semantics_.fluents()[fluent].symbol].boolean;
  }

  /// @param description  whose fluent it is
  /// @throws InvalidArgument  a value that the fluent cannot have
  static void checkValues(const std::string& name, const Distribution& distribution,
                          const reasoner::Description& description)
  {
    const reasoner::FluentDeclaration* fluent =
        description.findFluent(name.substr(0, name.find('(')));
    const std::vector<std::string> values =
        fluent->value_sort ? description.findSort(*fluent->value_sort)->elements
                           : std::vector<std::string>{"false", "true"};
    for (const auto& [value, probability] : distribution)
    {
      if (value != kElsewhere && std::find(values.begin(), values.end(), value) == values.end())
      {
        throw InvalidArgument("initial knowledge of " + name + ": found '" + value +
                              "', expected " +
                              (fluent->value_sort ? "an element of " + *fluent->value_sort
                                                  : std::string("true or false")));
      }
    }
  }

  void addFine(const std::string& name, const Distribution& distribution)
  {
    const std::optional<std::size_t> fluent = semantics_.signature().findFluent(name);
    if (!fluent || *fluent >= semantics_.signature().numInertial())
    {
      if (domain_.description().findFluent(name.substr(0, name.find('('))) == nullptr)
      {
        throw InvalidArgument("initial knowledge of '" + name +
                              "': no such fluent on the low level");
      }
      return;  // outside the zoom
    }
    checkValues(name, distribution, domain_.description());
    checkDistribution(name, distribution, false);
    addFactor(name, *fluent, distribution, true);
  }

  void addPrior(const std::string& name, const Distribution& distribution)
  {
    const std::optional<std::size_t> fluent = semantics_.signature().findFluent(name);
    if (fluent && *fluent < semantics_.signature().numInertial())
    {
      addFactor(name, *fluent, distribution, false);
    }
  }

  void addFactor(const std::string& name, std::size_t fluent, const Distribution& distribution,
                 bool strict)
  {
    Distribution inside;
    for (const auto& [value, probability] : distribution)
    {
      if (probability > 0.0)
      {
        inside[isOutside(value, zoom_) ? kElsewhere : value] += probability;
      }
    }
    factors_.emplace_back(name, std::vector<std::size_t>{fluent}, isBoolean(fluent), false,
                          std::move(inside), strict);
    known_.insert(fluent);
  }

  void addCoarse(const std::string& name, const Distribution& distribution)
  {
    const auto fluents = coarse_fluents_.find(name);
    if (fluents == coarse_fluents_.end())
    {
      if (domain_.highLevel().findFluent(name.substr(0, name.find('('))) == nullptr)
      {
        throw InvalidArgument("initial knowledge of '" + name +
                              "': no such fluent on the high level");
      }
      return;  // outside the zoom
    }
    checkValues(name, distribution, domain_.highLevel());
    checkDistribution(name, distribution, true);
    const bool boolean = isBoolean(fluents->second.front());
    double rest = 1.0;
    Distribution inside;
    for (const auto& [value, probability] : distribution)
    {
      if (!isOutside(value, zoom_) && probability > 0.0)
      {
        inside[value] += probability;
        rest -= probability;
      }
    }
    if (rest > 1e-12)
    {
      inside[boolean ? "false" : kElsewhere] += rest;
    }
    factors_.emplace_back(name, fluents->second, boolean, true, std::move(inside));
    known_.insert(fluents->second.begin(), fluents->second.end());
  }

  /// What neither map tells: the value in s1.
  void addFromStart(const std::string& name, const std::vector<std::size_t>& fluents)
  {
    std::vector<std::size_t> open;
    std::copy_if(fluents.begin(), fluents.end(), std::back_inserter(open),
                 [this](std::size_t fluent) { return known_.count(fluent) == 0; });
    if (open.empty())
    {
      return;
    }
    const auto literal = std::find_if(zoom_.start.begin(), zoom_.start.end(),
                                      [&](const reasoner::Literal& candidate) {
      return reasoner::toString(candidate.atom) == name;
    });
    if (literal != zoom_.start.end() && !isOutside(literal->value.name, zoom_))
    {
      factors_.emplace_back(name, open, isBoolean(open.front()), true,
                            Distribution{{literal->value.name, 1.0}});
    }
    else if (literal == zoom_.start.end() && isBoolean(open.front()))
    {
      factors_.emplace_back(name, open, true, true, Distribution{{"false", 1.0}});
    }
    else if (literal == zoom_.start.end())
    {
      throw FailedPrecondition("the start of " + zoom_.action + " gives " + name +
                               " no value; give one in the state or in the initial knowledge");
    }
    else
    {
      throw FailedPrecondition("the start of " + zoom_.action + " gives " + name + " the value '" +
                               literal->value.name +
                               "', which is outside the zoom; give it in the initial knowledge");
    }
  }

  const LowLevelDomain& domain_;
  const Zoom& zoom_;
  const Semantics& semantics_;
  CoarseFluents coarse_fluents_;
  std::vector<Factor> factors_;
  std::set<std::size_t> known_;
};

}  // namespace

CoarseFluents coarseFluents(const LowLevelDomain& domain, const Semantics& semantics)
{
  CoarseFluents result;
  for (std::size_t i = 0; i < semantics.signature().numInertial(); ++i)
  {
    const PhysicalFluent& fluent = semantics.fluents()[i];
    reasoner::Atom atom{semantics.signature().symbols()[fluent.symbol].name, {}, {}};
    for (const int argument : fluent.arguments)
    {
      atom.arguments.push_back({false, domain.coarse(semantics.vocabulary().name(argument))});
    }
    result[reasoner::toString(atom)].push_back(i);
  }
  return result;
}

std::string coarseValue(const std::vector<std::string>& fine_values, bool boolean)
{
  if (boolean)
  {
    return std::find(fine_values.begin(), fine_values.end(), "true") == fine_values.end() ? "false"
                                                                                          : "true";
  }
  const bool agree =
      std::all_of(fine_values.begin(), fine_values.end(),
                  [&](const std::string& value) { return value == fine_values.front(); });
  return agree ? fine_values.front() : "several";
}

std::set<std::string> withElsewhere(const LowLevelDomain& domain, const Zoom& zoom,
                                    const InitialKnowledge& knowledge,
                                    const std::map<std::string, Distribution>& priors)
{
  std::set<std::string> result;
  std::map<std::string, Distribution> fine = knowledge.fine;
  fine.insert(priors.begin(), priors.end());
  for (const auto& [text, distribution] : fine)
  {
    for (const auto& [value, probability] : distribution)
    {
      if (probability > 0.0 && isOutside(value, zoom))
      {
        result.insert(normalised(text));
      }
    }
  }
  if (!knowledge.coarse.empty())
  {
    const Semantics semantics(domain.description(), &zoom.constants);
    const CoarseFluents coarse_fluents = coarseFluents(domain, semantics);
    for (const auto& [text, distribution] : knowledge.coarse)
    {
      const auto fluents = coarse_fluents.find(normalised(text));
      for (const std::size_t fluent :
           fluents == coarse_fluents.end() ? std::vector<std::size_t>{} : fluents->second)
      {
        if (!semantics.signature().symbols()[semantics.fluents()[fluent].symbol].boolean)
        {
          result.insert(semantics.fluents()[fluent].name);
        }
      }
    }
  }
  return result;
}

std::vector<double> initialWeights(const LowLevelDomain& domain, const Zoom& zoom,
                                   const InitialKnowledge& knowledge,
                                   const std::map<std::string, Distribution>& priors,
                                   const Semantics& semantics, const std::vector<Values>& states)
{
  return Prior(domain, zoom, knowledge, priors, semantics).weights(states);
}

}  // namespace kr3::refinement
