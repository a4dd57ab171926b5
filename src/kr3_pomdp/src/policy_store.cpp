#include "kr3_pomdp/policy_store.hpp"

#include <iterator>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxGone = 4096;  // ids that are remembered
constexpr const char* kEvicted = "was evicted when memory ran out";

double secondsSince(std::chrono::steady_clock::time_point time)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - time).count();
}

std::string hashOf(const ModelText& text)
{
  return contentHash(text.format + ' ' + text.text);
}

}  // namespace

PolicyStore::PolicyStore(const Limits& limits, std::string prefix)
  : limits_(limits), prefix_(std::move(prefix))
{
  if (limits.max_bytes == 0 || limits.max_beliefs == 0)
  {
    throw InvalidArgument("a store of 0 bytes or 0 beliefs, expected more");
  }
}

PolicyStore::Policies::iterator PolicyStore::find(const std::string& id)
{
  const auto found = policy_index_.find(id);
  if (found == policy_index_.end())
  {
    failGone("policy", id);
  }
  return found->second;
}

PolicyStore::Beliefs::iterator PolicyStore::findBelief(const std::string& id)
{
  const auto found = belief_index_.find(id);
  if (found == belief_index_.end())
  {
    failGone("belief", id);
  }
  return found->second;
}

void PolicyStore::noteGone(const std::string& id, const std::string& why)
{
  if (gone_.insert_or_assign(id, why).second)
  {
    gone_order_.push_back(id);
  }
  if (gone_order_.size() > kMaxGone)
  {
    gone_.erase(gone_order_.front());
    gone_order_.pop_front();
  }
}

void PolicyStore::failGone(const std::string& kind, const std::string& id) const
{
  const std::string repair = kind == "policy" ? "solve the model again" : "create it again";
  const auto found = gone_.find(id);
  if (found != gone_.end())
  {
    throw NotFound(kind + " '" + id + "' " + found->second + ": " + repair);
  }
  throw NotFound("no " + kind + " '" + id.substr(0, 100) + "' (any more): " + repair);
}

StoredPolicy PolicyStore::described(const PolicyEntry& entry) const
{
  return {entry.id,
          entry.solved,
          entry.num_beliefs,
          entry.bytes,
          secondsSince(entry.put),
          secondsSince(entry.used)};
}

StoredBelief PolicyStore::described(const BeliefEntry& entry)
{
  return {entry.id, entry.policy_id, entry.belief, secondsSince(entry.created),
          secondsSince(entry.used)};
}

void PolicyStore::touch(Policies::iterator entry)
{
  entry->used = Clock::now();
  policies_.splice(policies_.begin(), policies_, entry);
}

void PolicyStore::remove(Beliefs::iterator entry, const std::string& why, Removed& removed)
{
  if (const auto policy = policy_index_.find(entry->policy_id); policy != policy_index_.end())
  {
    --policy->second->num_beliefs;
  }
  bytes_ -= entry->bytes;
  belief_index_.erase(entry->id);
  noteGone(entry->id, why);
  removed.beliefs.splice(removed.beliefs.begin(), beliefs_, entry);
}

std::size_t PolicyStore::remove(Policies::iterator entry, const std::string& why, Removed& removed)
{
  std::size_t num_beliefs = 0;
  for (auto belief = beliefs_.begin(); entry->num_beliefs > 0 && belief != beliefs_.end();)
  {
    const auto next = std::next(belief);
    if (belief->policy_id == entry->id)
    {
      remove(belief, why + " with its policy", removed);
      ++num_beliefs;
    }
    belief = next;
  }
  const auto [first, last] = ids_of_text_.equal_range(entry->text_hash);
  for (auto of_text = first; of_text != last; ++of_text)
  {
    if (of_text->second == entry->id)
    {
      ids_of_text_.erase(of_text);
      break;
    }
  }
  bytes_ -= entry->bytes;
  policy_index_.erase(entry->id);
  noteGone(entry->id, why);
  removed.policies.splice(removed.policies.begin(), policies_, entry);
  return num_beliefs;
}

void PolicyStore::makeRoom(std::size_t bytes, const std::string& keep_policy,
                           const std::string& keep_belief, Removed& removed)
{
  while (bytes_ + bytes > limits_.max_bytes)
  {
    auto victim = policies_.end();  // used longest ago, without beliefs if there is one
    for (auto entry = policies_.begin(); entry != policies_.end(); ++entry)
    {
      if (entry->id != keep_policy &&
          (victim == policies_.end() || entry->num_beliefs == 0 || victim->num_beliefs > 0))
      {
        victim = entry;
      }
    }
    if (victim != policies_.end())
    {
      ++evicted_policies_;
      evicted_beliefs_ += remove(victim, kEvicted, removed);
      continue;
    }
    auto oldest = beliefs_.end();
    for (auto entry = beliefs_.begin(); entry != beliefs_.end(); ++entry)
    {
      if (entry->id != keep_belief)
      {
        oldest = entry;
      }
    }
    if (oldest == beliefs_.end())
    {
      return;  // what is kept is too large by itself; the callers see to that
    }
    ++evicted_beliefs_;
    remove(oldest, kEvicted, removed);
  }
}

std::string PolicyStore::put(std::shared_ptr<const SolvedModel> solved)
{
  const std::string text_hash = hashOf(solved->source->text);
  std::string id = contentHash(*solved);
  const std::size_t bytes = sizeof(PolicyEntry) + solved->sizeInBytes();
  if (bytes > limits_.max_bytes)
  {
    throw ResourceExhausted("a policy of " + std::to_string(bytes) + " bytes, the store holds " +
                            std::to_string(limits_.max_bytes));
  }
  Removed removed;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (solved->reason == StopReason::kCancelled)
  {
    id += "-" + std::to_string(++num_preempted_) + "-preempted";
  }
  const Clock::time_point now = Clock::now();
  if (const auto known = policy_index_.find(id); known != policy_index_.end())
  {
    PolicyEntry& entry = *known->second;
    bytes_ = bytes_ - entry.bytes + bytes;
    entry.bytes = bytes;
    entry.put = now;
    std::swap(entry.solved, solved);  // what was there is freed with the argument
    touch(known->second);
    makeRoom(0, id, "", removed);
    return id;
  }
  makeRoom(bytes, "", "", removed);
  policies_.push_front({id, text_hash, std::move(solved), bytes, 0, now, now});
  policy_index_[id] = policies_.begin();
  ids_of_text_.emplace(text_hash, id);
  gone_.erase(id);
  bytes_ += bytes;
  return id;
}

std::shared_ptr<const SolvedModel> PolicyStore::policy(const std::string& id)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = find(id);
  touch(entry);
  return entry->solved;
}

StoredPolicy PolicyStore::info(const std::string& id)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return described(*find(id));
}

std::optional<StoredPolicy> PolicyStore::find(const ModelText& text, const SolverLimits& wanted)
{
  const std::string text_hash = hashOf(text);
  const std::lock_guard<std::mutex> lock(mutex_);
  auto best = policies_.end();
  const auto [first, last] = ids_of_text_.equal_range(text_hash);
  for (auto of_text = first; of_text != last; ++of_text)
  {
    const auto entry = policy_index_.at(of_text->second);
    const SolvedModel& solved = *entry->solved;
    if (solved.source->text == text && answers(solved, wanted) &&
        (best == policies_.end() ||
         solved.upper - solved.lower < best->solved->upper - best->solved->lower))
    {
      best = entry;
    }
  }
  if (best == policies_.end())
  {
    return std::nullopt;
  }
  touch(best);
  return described(*best);
}

std::shared_ptr<const NamedModel> PolicyStore::findModel(const ModelText& text)
{
  const std::string text_hash = hashOf(text);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto [first, last] = ids_of_text_.equal_range(text_hash);
  for (auto of_text = first; of_text != last; ++of_text)
  {
    const auto& source = policy_index_.at(of_text->second)->solved->source;
    if (source->text == text)
    {
      return source;
    }
  }
  return nullptr;
}

std::vector<StoredPolicy> PolicyStore::policies() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<StoredPolicy> result;
  for (const PolicyEntry& entry : policies_)
  {
    result.push_back(described(entry));
  }
  return result;
}

std::size_t PolicyStore::release(const std::string& id)
{
  Removed removed;
  const std::lock_guard<std::mutex> lock(mutex_);
  return remove(find(id), "was released", removed);
}

StoredBelief PolicyStore::create(const std::string& policy_id, const Belief& belief)
{
  const auto solved = policy(policy_id);
  const auto kept = std::make_shared<KeptBelief>(solved, belief);
  const std::size_t bytes = sizeof(BeliefEntry) + kept->sizeInBytes();
  if (bytes + sizeof(PolicyEntry) + solved->sizeInBytes() > limits_.max_bytes)
  {
    throw ResourceExhausted("a belief of " + std::to_string(bytes) + " bytes on a policy of " +
                            std::to_string(solved->sizeInBytes()) + ", the store holds " +
                            std::to_string(limits_.max_bytes));
  }
  Removed removed;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = find(policy_id);
  makeRoom(bytes, policy_id, "", removed);
  while (beliefs_.size() >= limits_.max_beliefs)
  {
    ++evicted_beliefs_;
    remove(std::prev(beliefs_.end()),
           "was evicted, there were more than " + std::to_string(limits_.max_beliefs), removed);
  }
  const Clock::time_point now = Clock::now();
  beliefs_.push_front(
      {prefix_ + '-' + std::to_string(++num_created_), policy_id, kept, bytes, now, now});
  belief_index_[beliefs_.front().id] = beliefs_.begin();
  ++entry->num_beliefs;
  touch(entry);
  bytes_ += bytes;
  return described(beliefs_.front());
}

StoredBelief PolicyStore::belief(const std::string& id)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = findBelief(id);
  entry->used = Clock::now();
  beliefs_.splice(beliefs_.begin(), beliefs_, entry);
  touch(policy_index_.at(entry->policy_id));
  return described(*entry);
}

void PolicyStore::resized(const std::string& id)
{
  Removed removed;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = belief_index_.find(id);
  if (found == belief_index_.end())
  {
    return;  // it went while it was being changed
  }
  BeliefEntry& entry = *found->second;
  bytes_ -= entry.bytes;
  entry.bytes = sizeof(BeliefEntry) + entry.belief->sizeInBytes();
  bytes_ += entry.bytes;
  makeRoom(0, entry.policy_id, id, removed);
}

void PolicyStore::erase(const std::string& id)
{
  Removed removed;
  const std::lock_guard<std::mutex> lock(mutex_);
  remove(findBelief(id), "was deleted", removed);
}

std::vector<StoredBelief> PolicyStore::beliefs(const std::string& policy_id) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<StoredBelief> result;
  for (const BeliefEntry& entry : beliefs_)
  {
    if (policy_id.empty() || entry.policy_id == policy_id)
    {
      result.push_back(described(entry));
    }
  }
  return result;
}

StoreStatistics PolicyStore::statistics() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return {policies_.size(), beliefs_.size(), bytes_, evicted_policies_, evicted_beliefs_};
}

}  // namespace kr3::pomdp
