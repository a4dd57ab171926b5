#include "kr3_refinement/state_space.hpp"

#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "semantics.hpp"
#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

struct ValuesHash
{
  std::size_t operator()(const Values& values) const
  {
    std::size_t hash = 1469598103934665603ULL;
    for (const int value : values)
    {
      hash = (hash ^ static_cast<std::size_t>(value + 1)) * 1099511628211ULL;
    }
    return hash;
  }
};

}  // namespace

class StateSpace::Impl
{
public:
  Impl(const reasoner::Description& description, const std::set<std::string>& constants)
    : semantics(description, &constants), ground(semantics.actions())
  {
    const auto name = [this](int constant) { return semantics.vocabulary().name(constant); };
    const auto names = [&](const std::vector<int>& ids) {
      std::vector<std::string> result;
      for (const int id : ids)
      {
        result.push_back(name(id));
      }
      return result;
    };
    for (std::size_t i = 0; i < semantics.signature().numInertial(); ++i)
    {
      const PhysicalFluent& fluent = semantics.fluents()[i];
      reasoner::GroundFluent shown;
      shown.name = fluent.name;
      shown.symbol = semantics.signature().symbols()[fluent.symbol].name;
      shown.arguments = names(fluent.arguments);
      shown.values = names(fluent.values);
      shown.kind = reasoner::FluentKind::kInertial;
      fluents.push_back(std::move(shown));
    }
    for (const GroundAction& action : ground)
    {
      actions.push_back({action.name, action.symbol, names(action.arguments)});
      std::vector<Observation> told;
      for (const GroundObservation& law : semantics.observations(action))
      {
        told.push_back(
            {law.fluent,
             law.value == Vocabulary::kNone ? std::nullopt : std::optional(name(law.value)),
             semantics.affects(action, law.fluent)});
      }
      observations.push_back(std::move(told));
    }
  }

  StateId number(const Values& values)
  {
    const auto [entry, is_new] = index.emplace(values, static_cast<StateId>(states.size()));
    if (is_new)
    {
      states.push_back(&entry->first);
    }
    return entry->second;
  }

  Semantics semantics;
  std::vector<GroundAction> ground;
  std::vector<reasoner::GroundFluent> fluents;
  std::vector<Action> actions;
  std::vector<std::vector<Observation>> observations;
  std::unordered_map<Values, StateId, ValuesHash> index;
  std::vector<const Values*> states;  // keys of `index`, which never move
};

StateSpace::StateSpace(const reasoner::Description& description,
                       const std::set<std::string>& constants)
  : impl_(std::make_unique<Impl>(description, constants))
{
}

StateSpace::~StateSpace() = default;
StateSpace::StateSpace(StateSpace&&) noexcept = default;
StateSpace& StateSpace::operator=(StateSpace&&) noexcept = default;

const std::vector<reasoner::GroundFluent>& StateSpace::fluents() const
{
  return impl_->fluents;
}

std::optional<std::size_t> StateSpace::findFluent(const std::string& name) const
{
  const auto fluent = impl_->semantics.signature().findFluent(normalised(name));
  return fluent && *fluent < impl_->fluents.size() ? fluent : std::nullopt;
}

const std::vector<StateSpace::Action>& StateSpace::actions() const
{
  return impl_->actions;
}

const std::vector<StateSpace::Observation>& StateSpace::observations(std::size_t action) const
{
  return impl_->observations.at(action);
}

std::optional<StateId> StateSpace::find(const std::vector<std::string>& values)
{
  const Semantics& semantics = impl_->semantics;
  if (values.size() != impl_->fluents.size())
  {
    throw InvalidArgument(std::to_string(values.size()) + " values, expected " +
                          std::to_string(impl_->fluents.size()));
  }
  Values state(semantics.fluents().size(), Vocabulary::kNone);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    state[i] = semantics.vocabulary().find(values[i]);
    if (state[i] == Vocabulary::kNone)
    {
      throw InvalidArgument("'" + values[i] + "' is no value of " + impl_->fluents[i].name);
    }
  }
  return semantics.complete(state) ? std::optional(impl_->number(state)) : std::nullopt;
}

const std::string& StateSpace::value(StateId state, std::size_t fluent) const
{
  return impl_->semantics.vocabulary().name(impl_->states.at(state)->at(fluent));
}

std::size_t StateSpace::numStatesMet() const
{
  return impl_->states.size();
}

bool StateSpace::executable(StateId state, std::size_t action) const
{
  return !impl_->semantics.forbidden(*impl_->states.at(state), impl_->ground.at(action));
}

std::vector<StateSpace::Outcome> StateSpace::results(StateId state, std::size_t action)
{
  std::vector<Outcome> outcomes;
  const Values before = *impl_->states.at(state);
  for (Result& result : impl_->semantics.results(before, impl_->ground.at(action)))
  {
    outcomes.push_back(
        {std::move(result.label), result.share,
         result.outside ? std::nullopt : std::optional(impl_->number(result.values))});
  }
  return outcomes;
}

}  // namespace kr3::refinement
