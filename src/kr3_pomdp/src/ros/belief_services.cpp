#include "belief_services.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_msgs/AdvanceBelief.h>
#include <kr3_msgs/CreateBelief.h>
#include <kr3_msgs/DeleteBelief.h>
#include <kr3_msgs/GetBelief.h>
#include <kr3_msgs/GetPolicyAction.h>
#include <kr3_msgs/ListBeliefs.h>
#include <kr3_msgs/ResetBelief.h>
#include <kr3_msgs/UpdateBelief.h>

#include "conversions.hpp"
#include "kr3_pomdp/names.hpp"

namespace kr3::pomdp
{

namespace
{

/// A belief, or the initial one when the message has none.
template <typename Request>
Belief wantedBelief(const Model& model, const Request& request)
{
  if (request.belief.empty() && request.states.empty())
  {
    return initialBelief(model, request.first_look);
  }
  if (!request.first_look.empty())
  {
    throw InvalidArgument("both a belief and first_look, expected one of them");
  }
  return beliefFromMsg(request.belief, request.states, model.numStates());
}

/// Puts entries into a message, as `states` and their probabilities.
template <typename Response>
void fillSparse(const std::vector<SparseEntry>& entries, Response& response)
{
  response.states.reserve(entries.size());
  response.belief.reserve(entries.size());
  for (const SparseEntry& entry : entries)
  {
    response.states.push_back(entry.index);
    response.belief.push_back(entry.probability);
  }
}

/// The most probable entries, by ascending state again.
std::vector<SparseEntry> mostProbable(std::vector<SparseEntry> entries, std::size_t count)
{
  if (count == 0 || count >= entries.size())
  {
    return entries;
  }
  std::partial_sort(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(count),
                    entries.end(),
                    [](const SparseEntry& a, const SparseEntry& b) {
    return a.probability > b.probability || (a.probability == b.probability && a.index < b.index);
  });
  entries.resize(count);
  std::sort(entries.begin(), entries.end(),
            [](const SparseEntry& a, const SparseEntry& b) { return a.index < b.index; });
  return entries;
}

void getAction(PolicyStore& store, const kr3_msgs::GetPolicyAction::Request& request,
               kr3_msgs::GetPolicyAction::Response& response)
{
  const auto solved = store.policy(request.policy_id);
  const Belief belief = beliefFromMsg(request.belief, request.states, solved->model().numStates());
  const auto choice = choiceAt(*solved, belief);
  if (!choice)
  {
    throw FailedPrecondition("'" + request.policy_id +
                             "' is a model without a policy: solve it, or plan online");
  }
  response.action_index = static_cast<std::uint32_t>(choice->action);
  response.action = solved->model().actionName(choice->action);
  response.value = choice->value;
}

void updateBelief(PolicyStore& store, const kr3_msgs::UpdateBelief::Request& request,
                  kr3_msgs::UpdateBelief::Response& response)
{
  const auto solved = store.policy(request.policy_id);
  const Model& model = solved->model();
  const BeliefUpdate update =
      updated(model, beliefFromMsg(request.belief, request.states, model.numStates()),
              actionNamed(model, request.action), observationNamed(model, request.observation));
  response.probability = update.probability;
  if (request.states.empty())
  {
    response.belief = update.posterior.probabilities();
  }
  else
  {
    fillSparse(sparse(update.posterior), response);
  }
}

void createBelief(PolicyStore& store, const kr3_msgs::CreateBelief::Request& request,
                  kr3_msgs::CreateBelief::Response& response)
{
  const auto solved = store.policy(request.policy_id);
  const Belief belief = wantedBelief(solved->model(), request);
  fillChoice(*solved, belief, response, response.action);
  const StoredBelief stored = store.create(request.policy_id, belief);
  response.belief_id = stored.id;
  response.version = stored.belief->version();
}

void advanceBelief(PolicyStore& store, const kr3_msgs::AdvanceBelief::Request& request,
                   kr3_msgs::AdvanceBelief::Response& response)
{
  const StoredBelief stored = store.belief(request.belief_id);
  const KeptBelief::Advanced advanced =
      stored.belief->advance(request.action, request.observation, request.version);
  store.resized(request.belief_id);
  response.version = advanced.now.version;
  response.probability = advanced.probability;
  fillChoice(stored.belief->solved(), advanced.now.belief, response, response.next_action);
}

void getBelief(PolicyStore& store, const kr3_msgs::GetBelief::Request& request,
               kr3_msgs::GetBelief::Response& response)
{
  const StoredBelief stored = store.belief(request.belief_id);
  const KeptBelief::Snapshot now = stored.belief->snapshot();
  response.policy_id = stored.policy_id;
  response.version = now.version;
  if (request.dense != 0 && request.max_states != 0)
  {
    throw InvalidArgument("both dense and max_states, expected one of them");
  }
  if (request.dense != 0)
  {
    response.belief = now.belief.probabilities();
  }
  else
  {
    fillSparse(mostProbable(sparse(now.belief), request.max_states), response);
  }
  fillChoice(stored.belief->solved(), now.belief, response, response.action);
}

void resetBelief(PolicyStore& store, const kr3_msgs::ResetBelief::Request& request,
                 kr3_msgs::ResetBelief::Response& response)
{
  const StoredBelief stored = store.belief(request.belief_id);
  const SolvedModel& solved = stored.belief->solved();
  const KeptBelief::Snapshot now = stored.belief->reset(wantedBelief(solved.model(), request));
  store.resized(request.belief_id);
  response.version = now.version;
  fillChoice(solved, now.belief, response, response.action);
}

void listBeliefs(const PolicyStore& store, const kr3_msgs::ListBeliefs::Request& request,
                 kr3_msgs::ListBeliefs::Response& response)
{
  for (const StoredBelief& stored : store.beliefs(request.policy_id))
  {
    response.beliefs.push_back(toMsg(stored));
  }
  response.max_beliefs = static_cast<std::uint32_t>(store.limits().max_beliefs);
}

}  // namespace

void offerBeliefServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                         ServiceList& services)
{
  // Each holds the store: a call may still run while the node ends.
  const auto with = [store](const auto& answer) {
    return
        [store, answer](const auto& request, auto& response) { answer(*store, request, response); };
  };
  services.offer<kr3_msgs::GetPolicyAction>(nh, names::kGetAction, with(getAction));
  services.offer<kr3_msgs::UpdateBelief>(nh, names::kUpdateBelief, with(updateBelief));
  services.offer<kr3_msgs::CreateBelief>(nh, names::kCreateBelief, with(createBelief));
  services.offer<kr3_msgs::AdvanceBelief>(nh, names::kAdvanceBelief, with(advanceBelief));
  services.offer<kr3_msgs::GetBelief>(nh, names::kGetBelief, with(getBelief));
  services.offer<kr3_msgs::ResetBelief>(nh, names::kResetBelief, with(resetBelief));
  services.offer<kr3_msgs::ListBeliefs>(nh, names::kListBeliefs, with(listBeliefs));
  services.offer<kr3_msgs::DeleteBelief>(
      nh, names::kDeleteBelief,
      [store](const auto& request, auto& /*response*/) { store->erase(request.belief_id); });
}

}  // namespace kr3::pomdp
