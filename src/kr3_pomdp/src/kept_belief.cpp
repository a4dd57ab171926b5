#include "kr3_pomdp/kept_belief.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/nearest_name.hpp>

namespace kr3::pomdp
{

namespace
{

/// @param name_of  the name at an index below `count`
template <typename NameOf>
[[noreturn]] void failUnknown(const std::string& kind, const std::string& name, std::size_t count,
                              const NameOf& name_of)
{
  std::vector<std::string> names;
  names.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    names.push_back(name_of(i));
  }
  std::string message = "the model has no " + kind + " '" + name.substr(0, 100) + "'";
  if (name.size() <= 100)
  {
    const std::size_t near = std::max<std::size_t>(2, name.size() / 3);
    if (const std::string* nearest = nearestName(name, names, near))
    {
      message += "; did you mean '" + *nearest + "'?";
    }
  }
  throw InvalidArgument(message);
}

void checkSize(const Model& model, const Belief& belief)
{
  if (belief.size() != model.numStates())
  {
    throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(model.numStates()));
  }
}

}  // namespace

std::vector<SparseEntry> sparse(const Belief& belief)
{
  std::vector<SparseEntry> entries;
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      entries.push_back({static_cast<std::uint32_t>(s), belief[s]});
    }
  }
  return entries;
}

Belief dense(const std::vector<SparseEntry>& entries, std::size_t num_states)
{
  std::vector<double> probabilities(num_states, 0.0);
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    const std::uint32_t state = entries[i].index;
    if (state >= num_states)
    {
      throw InvalidArgument("belief in state " + std::to_string(state) + " of " +
                            std::to_string(num_states));
    }
    if (i > 0 && state <= entries[i - 1].index)
    {
      throw InvalidArgument("belief in state " + std::to_string(state) + " after state " +
                            std::to_string(entries[i - 1].index) +
                            ", expected ascending states, each once");
    }
    probabilities[state] = entries[i].probability;
  }
  return Belief(std::move(probabilities));
}

std::size_t actionNamed(const Model& model, const std::string& name)
{
  if (const auto found = model.findAction(name))
  {
    return *found;
  }
  failUnknown("action", name, model.numActions(),
              [&model](std::size_t i) { return model.actionName(i); });
}

std::size_t observationNamed(const Model& model, const std::string& name)
{
  if (const auto found = model.findObservation(name))
  {
    return *found;
  }
  failUnknown("observation", name, model.numObservations(),
              [&model](std::size_t i) { return model.observationName(i); });
}

std::size_t stateNamed(const Model& model, const std::string& name)
{
  if (const auto found = model.findState(name))
  {
    return *found;
  }
  failUnknown("state", name, model.numStates(),
              [&model](std::size_t i) { return model.stateName(i); });
}

Belief initialBelief(const Model& model, const std::string& first_look)
{
  const std::vector<InitialOutcome> outcomes = model.initialOutcomes();
  if (first_look.empty())
  {
    if (outcomes.size() > 1)
    {
      throw InvalidArgument("the robot sees part of the state before its first action, one of " +
                            std::to_string(outcomes.size()) +
                            " values: first_look must name a state that looks like the true one");
    }
    return outcomes.front().belief;
  }
  const std::size_t state = stateNamed(model, first_look);
  const std::vector<std::uint32_t>& labels = model.initialLabels();
  if (labels.empty())
  {
    throw InvalidArgument("first_look '" + first_look +
                          "', but the robot sees nothing before its first action");
  }
  for (const InitialOutcome& outcome : outcomes)
  {
    const std::vector<SparseEntry> entries = sparse(outcome.belief);
    if (labels[entries.front().index] == labels[state])
    {
      return outcome.belief;
    }
  }
  throw FailedPrecondition("what is seen in state '" + first_look + "' is impossible at the start");
}

KeptBelief::KeptBelief(std::shared_ptr<const SolvedModel> solved, const Belief& belief)
  : solved_(std::move(solved)), entries_(sparse(belief))
{
  checkSize(solved_->model(), belief);
}

KeptBelief::Snapshot KeptBelief::snapshot() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return {dense(entries_, solved_->model().numStates()), version_};
}

std::uint64_t KeptBelief::version() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return version_;
}

std::size_t KeptBelief::numNonzero() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return entries_.size();
}

std::size_t KeptBelief::sizeInBytes() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return sizeof(KeptBelief) + entries_.capacity() * sizeof(SparseEntry);
}

KeptBelief::Snapshot KeptBelief::set(const Belief& belief)
{
  entries_ = sparse(belief);
  ++version_;
  return {belief, version_};
}

KeptBelief::Advanced KeptBelief::advance(const std::string& action, const std::string& observation,
                                         std::uint64_t version)
{
  const Model& model = solved_->model();
  const std::size_t done = actionNamed(model, action);
  const std::size_t seen = observationNamed(model, observation);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (version != 0 && version != version_)
  {
    throw FailedPrecondition("the belief has version " + std::to_string(version_) + ", expected " +
                             std::to_string(version));
  }
  const BeliefUpdate update = updated(model, dense(entries_, model.numStates()), done, seen);
  return {set(update.posterior), update.probability};
}

KeptBelief::Snapshot KeptBelief::reset(const Belief& belief)
{
  checkSize(solved_->model(), belief);
  const std::lock_guard<std::mutex> lock(mutex_);
  return set(belief);
}

std::optional<Policy::Choice> choiceAt(const SolvedModel& solved, const Belief& belief)
{
  checkSize(solved.model(), belief);
  if (!solved.policy)
  {
    return std::nullopt;
  }
  return solved.policy->bestAt(belief);
}

}  // namespace kr3::pomdp
