#include "kr3_executive/low_level_task.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using refinement::Distribution;
using refinement::kElsewhere;
using refinement::kNoObservation;
using refinement::kOutside;

std::string symbolOf(const std::string& atom)
{
  return atom.substr(0, atom.find('('));
}

std::string substituted(const reasoner::Term& term,
                        const std::map<std::string, std::string>& binding)
{
  if (!term.is_variable)
    return term.name;
  const auto found = binding.find(term.name);
  return found == binding.end() ? term.name : found->second;
}

Distribution normalised(Distribution values)
{
  values.erase(kOutside);
  double sum = 0.0;
  for (const auto& entry : values)
    sum += entry.second;
  if (sum <= 0.0)
    return {};
  for (auto& entry : values)
    entry.second /= sum;
  return values;
}

std::string firstOf(const Distribution& values)
{
  return std::max_element(values.begin(), values.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// All values alike of a fluent that only the low level has: no history says where it may be.
/// Nothing for others.
Distribution anyOfTheLowLevel(const refinement::LowLevelDomain& domain, const std::string& fluent)
{
  Distribution values;
  const auto* declared = domain.description().findFluent(symbolOf(fluent));
  if (domain.highLevel().findFluent(symbolOf(fluent)) != nullptr || declared == nullptr ||
      !declared->value_sort)
    return values;
  for (const auto& element : domain.description().findSort(*declared->value_sort)->elements)
    values[element] = 1.0;
  return values;
}

/// The belief after an action and an observation that is right with a probability. What the model
/// holds for impossible stays so: what the robot always knows has to stay known, since a policy's
/// alpha vectors are over the states that agree with it.
/// @throws FailedPrecondition  the observation is impossible in the model at the belief
pomdp::Belief tempered(const pomdp::Model& model, const pomdp::Belief& belief, std::size_t action,
                       std::size_t observation, double confidence, std::size_t num_possible)
{
  pomdp::Belief exact = pomdp::updated(model, belief, action, observation).posterior;
  if (confidence >= 1.0)
    return exact;
  std::vector<double> next(model.numStates(), 0.0);
  for (std::size_t state = 0; state < next.size(); ++state)
  {
    if (belief[state] == 0.0)
      continue;
    for (const auto& entry : model.transitions(action, state))
      next[entry.index] += belief[state] * entry.probability;
  }
  double sum = 0.0;
  for (std::size_t state = 0; state < next.size(); ++state)
  {
    double modelled = 0.0;
    for (const auto& entry : model.observations(action, state))
      modelled += entry.index == observation ? entry.probability : 0.0;
    const double any = 1.0 / static_cast<double>(num_possible);
    next[state] *= modelled > 0.0 ? confidence * modelled + (1.0 - confidence) * any : 0.0;
    sum += next[state];
  }
  for (auto& probability : next)
    probability /= sum;
  return pomdp::Belief(std::move(next));
}

}  // namespace

std::vector<ObservedFluent> observedFluents(const reasoner::Description& low_level,
                                            const LowLevelAction& action)
{
  std::vector<ObservedFluent> observed;
  for (const auto& law : low_level.observations)
  {
    if (law.action.name != action.symbol || law.action.arguments.size() != action.arguments.size())
      continue;
    std::map<std::string, std::string> binding;
    bool fits = true;
    for (std::size_t i = 0; i < action.arguments.size(); ++i)
    {
      const auto& term = law.action.arguments[i];
      if (term.is_variable)
        fits = fits &&
               binding.emplace(term.name, action.arguments[i]).first->second == action.arguments[i];
      else
        fits = fits && term.name == action.arguments[i];
    }
    if (!fits)
      continue;
    reasoner::Atom fluent = law.fluent;
    for (auto& argument : fluent.arguments)
      argument = {false, substituted(argument, binding)};
    observed.push_back(
        {reasoner::toString(fluent), law.value ? substituted(*law.value, binding) : std::string()});
  }
  return observed;
}

LowLevelTask::LowLevelTask(const refinement::LowLevelDomain& domain,
                           std::shared_ptr<const refinement::PomdpTask> pomdp,
                           const refinement::InitialKnowledge& knowledge)
  : domain_(domain)
  , pomdp_(std::move(pomdp))
  , belief_(pomdp_->model().initialBelief())
  , symbol_(symbolOf(pomdp_->zoom().action))
  , remembered_(std::any_of(knowledge.fine.begin(), knowledge.fine.end(),
                            [](const auto& known) { return known.second.count(kElsewhere) != 0; }))
{
}

LowLevelAction LowLevelTask::action(std::size_t index) const
{
  return {pomdp_->model().actionName(index), pomdp_->actionSymbol(index),
          pomdp_->actionArguments(index)};
}

std::size_t LowLevelTask::observationIndex(std::size_t action,
                                           const std::vector<std::string>& observation) const
{
  const auto& possible = pomdp_->observationsOf(action);
  std::string name;
  for (const auto& value : observation)
    name += (name.empty() ? "" : ",") + value;
  if (observation.empty())
    name = kNoObservation;
  const auto index = pomdp_->model().findObservation(name);
  if (index && std::find(possible.begin(), possible.end(), *index) != possible.end())
    return *index;
  return pomdp_->model().numObservations();  // beyond the zoom
}

bool LowLevelTask::mayErr(std::size_t action, std::size_t observation) const
{
  if (observation == pomdp_->model().numObservations())
    return false;
  try
  {
    const auto posterior = pomdp::updated(pomdp_->model(), belief_, action, observation).posterior;
    return posterior.probabilities().at(pomdp_->boundaryState()) < 1.0 - 1e-9;
  }
  catch (const FailedPrecondition&)
  {
    return false;
  }
}

bool LowLevelTask::update(std::size_t action, const std::vector<std::string>& observation,
                          double confidence)
{
  const LowLevelAction executed = this->action(action);
  const auto laws = observedFluents(domain_.description(), executed);
  if (laws.size() != observation.size())
  {
    throw InvalidArgument(executed.text + " gave " + std::to_string(observation.size()) +
                          " observations, expected " + std::to_string(laws.size()));
  }
  if (!(confidence > 0.0 && confidence <= 1.0))
  {
    throw InvalidArgument(executed.text + " gave an observation with confidence " +
                          std::to_string(confidence) + ", expected (0, 1]");
  }
  attempted_ = attempted_ || executed.symbol == symbol_;
  std::vector<std::string> told = observation;
  observed_last_.clear();
  std::set<std::string> left;  // fluents that have no place outside the zoom, yet are told there
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    if (!laws[i].value.empty())
      continue;
    const auto& fluents = pomdp_->fluents();
    const auto zoomed = std::find_if(fluents.begin(), fluents.end(), [&](const auto& fluent) {
      return fluent.name == laws[i].fluent;
    });
    const bool is_zoomed = zoomed != fluents.end() && !zoomed->values.empty();
    const bool hidden = is_zoomed && zoomed->values.back() == kElsewhere;
    if (!hidden)
      observed_last_[laws[i].fluent] = observation[i];
    if (!is_zoomed ||
        std::find(zoomed->values.begin(), zoomed->values.end(), told[i]) != zoomed->values.end())
      continue;
    told[i] = kOutside;  // one more hint, which the belief weighs: sensors err
    if (!hidden)
      left.insert(laws[i].fluent);
  }
  const bool explained = left.empty() || mayErr(action, observationIndex(action, told));
  for (const std::string& fluent : left)
  {
    if (explained)
      observed_last_.erase(fluent);
  }
  for (const auto& [fluent, value] : observed_last_)
    observed_[fluent] = value;
  if (!explained)
    return false;
  const std::size_t index = observationIndex(action, told);
  if (index == pomdp_->model().numObservations())
    return false;
  try
  {
    belief_ = tempered(pomdp_->model(), belief_, action, index, confidence,
                       pomdp_->observationsOf(action).size());
  }
  catch (const FailedPrecondition&)
  {
    return false;
  }
  return true;
}

void LowLevelTask::notice(const SightingLikelihood& sighting)
{
  const std::string& fluent = sighting.fluent();
  const auto known = noticed_.find(fluent);
  noticed_[fluent] = sighting.applied(known == noticed_.end() ? unknownValue() : known->second);

  const auto& fluents = pomdp_->fluents();
  const auto zoomed = std::find_if(fluents.begin(), fluents.end(),
                                   [&](const auto& candidate) { return candidate.name == fluent; });
  if (zoomed == fluents.end())
    return;
  const auto index = static_cast<std::size_t>(zoomed - fluents.begin());
  std::vector<double> next = belief_.probabilities();
  const double outside = sighting.ofOthers(zoomed->values);
  double sum = 0.0;
  for (std::size_t state = 0; state < next.size(); ++state)
  {
    double likelihood = outside;
    if (pomdp_->kind(state) == refinement::PomdpTask::StateKind::kPhysical)
    {
      const auto value = static_cast<std::size_t>(pomdp_->physicalState(state)[index]);
      const std::string& name = zoomed->values[value];
      likelihood = name == kElsewhere ? outside : sighting.of(name);
    }
    next[state] *= likelihood;
    sum += next[state];
  }
  if (!(sum > 0.0))
    return;  // only where what was seen has probability 0: the belief cannot take it in
  for (auto& probability : next)
    probability /= sum;
  belief_ = pomdp::Belief(std::move(next));
}

std::optional<double> LowLevelTask::beliefIn(const std::string& coarse_fluent,
                                             const std::string& value) const
{
  const auto coarse = pomdp_->coarseFluents();
  if (std::find(coarse.begin(), coarse.end(), coarse_fluent) == coarse.end())
    return std::nullopt;
  const auto marginal = pomdp_->coarseMarginal(belief_, coarse_fluent);
  const auto entry = marginal.find(value);
  return entry == marginal.end() ? 0.0 : entry->second;
}

Assessment LowLevelTask::assess() const
{
  Assessment assessment;
  assessment.achieved = pomdp_->successProbability(belief_);
  assessment.remembered = remembered_;
  assessment.attempted = attempted_;
  for (const auto& effect : pomdp_->zoom().effects)
    assessment.effects.push_back(reasoner::toString(effect));
  for (const auto& literal : pomdp_->zoom().start)
  {
    const std::string name = reasoner::toString(literal.atom);
    const auto& fluents = pomdp_->fluents();
    const bool hidden = std::any_of(fluents.begin(), fluents.end(), [&](const auto& fluent) {
      return fluent.name == name && !fluent.values.empty() && fluent.values.back() == kElsewhere;
    });
    if (!hidden || !literal.equal)
      continue;
    const auto marginal = pomdp_->coarseMarginal(belief_, name);
    const auto elsewhere = marginal.find(kElsewhere);
    if (elsewhere != marginal.end())
      assessment.refutations.push_back({reasoner::toString(literal), elsewhere->second});
  }
  return assessment;
}

/// The zoom's belief with its mass on `elsewhere` divided among other values: by what was noticed
/// of them while the action lasted, else by what was remembered.
Distribution LowLevelTask::rememberedValues(const std::string& fluent, const Distribution& inside,
                                            const LowLevelMemory& memory) const
{
  Distribution values = inside;
  const auto elsewhere = values.find(kElsewhere);
  if (elsewhere == values.end())
    return values;
  Distribution others;
  const auto noticed = noticed_.find(fluent);
  const auto remembered = memory.find(fluent);
  const auto sawOutside = [&values](const Distribution& seen) {
    return std::any_of(seen.begin(), seen.end(), [&values](const auto& entry) {
      return entry.first != kElsewhere && values.count(entry.first) == 0;
    });
  };
  if (noticed != noticed_.end() && sawOutside(noticed->second))
    others = noticed->second;
  else if (remembered != memory.end())
    others = weighed(domain_, remembered->second);
  else
    others = anyOfTheLowLevel(domain_, fluent);
  // What the zoom lists is no longer among the values that `elsewhere` stands for.
  if (const auto rest = others.find(kElsewhere); rest != others.end())
  {
    Distribution listed = others;
    listed.insert(values.begin(), values.end());
    const std::size_t before = numUnlisted(domain_, fluent, others);
    if (before > 0)
      rest->second *=
          static_cast<double>(numUnlisted(domain_, fluent, listed)) / static_cast<double>(before);
  }
  double sum = 0.0;
  for (auto it = others.begin(); it != others.end();)
  {
    const bool outside = it->first == kElsewhere || values.count(it->first) == 0;
    sum += outside ? it->second : 0.0;
    it = outside ? std::next(it) : others.erase(it);
  }
  if (!(sum > 0.0))
    return values;
  const double mass = elsewhere->second;
  values.erase(elsewhere);
  for (const auto& [value, probability] : others)
    values[value] = mass * probability / sum;
  return values;
}

double LowLevelTask::oddsOf(const std::string& fluent, const std::string& value,
                            const LowLevelMemory& memory)
{
  const auto known = odds_.find(fluent);
  if (known != odds_.end())
    return known->second;
  double odds = 1.0;
  const std::vector<std::string> values = highLevelValues(domain_, fluent);
  const auto place = std::find(values.begin(), values.end(), value);
  if (place != values.end() && coarseFluent(domain_, fluent) == fluent)
  {
    const double before = probabilitiesOf(domain_, memory, fluent,
                                          values)[static_cast<std::size_t>(place - values.begin())];
    const double believed =
        massOf(domain_, pomdp_->fineMarginal(pomdp_->model().initialBelief(), fluent), value);
    if (before > 0.0 && before < 1.0 && believed > 0.0 && believed < 1.0)
      odds = std::min(before / (1.0 - before) * (1.0 - believed) / believed, 1.0);
  }
  odds_[fluent] = odds;
  return odds;
}

void LowLevelTask::remember(LowLevelMemory& memory)
{
  for (const auto& fluent : pomdp_->fluents())
  {
    const Distribution values = normalised(pomdp_->fineMarginal(belief_, fluent.name));
    if (values.empty())
      continue;
    const std::string most = firstOf(values);
    std::string assumed = most == kElsewhere ? std::string() : domain_.coarse(most);
    double odds = 1.0;
    for (const auto& literal : pomdp_->zoom().start)
    {
      if (reasoner::toString(literal.atom) != coarseFluent(domain_, fluent.name))
        continue;
      if (assumed.empty())
        assumed = literal.value.name;
      if (assumed == literal.value.name)
        odds = oddsOf(fluent.name, assumed, memory);
    }
    memory[fluent.name] = {rememberedValues(fluent.name, values, memory), std::move(assumed), odds};
  }
  for (const auto& [fluent, values] : noticed_)
  {
    const auto& zoomed = pomdp_->fluents();
    if (std::any_of(zoomed.begin(), zoomed.end(), [&](const auto& f) { return f.name == fluent; }))
      continue;
    const std::string most = firstOf(values);
    if (most != kElsewhere || memory.count(fluent) == 0)  // a faint sighting ousts no memory
      memory[fluent] = {values, most == kElsewhere ? std::string() : domain_.coarse(most)};
  }
  // What was observed last outweighs a belief that could not take it in.
  for (const auto& [fluent, value] : observed_)
  {
    const auto& fluents = pomdp_->fluents();
    const auto zoomed = std::find_if(fluents.begin(), fluents.end(),
                                     [&](const auto& f) { return f.name == fluent; });
    if (zoomed == fluents.end() ||
        std::find(zoomed->values.begin(), zoomed->values.end(), value) == zoomed->values.end())
      memory[fluent] = {{{value, 1.0}}, domain_.coarse(value)};
  }
}

}  // namespace kr3::executive
