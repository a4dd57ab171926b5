#include "policy_walk.hpp"

#include <algorithm>
#include <cstring>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

/// FNV-1a over words.
std::uint64_t hashOf(const std::vector<SparseEntry>& belief)
{
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto mix = [&hash](std::uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3ULL;
    hash ^= hash >> 32;
  };
  for (const SparseEntry& entry : belief)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &entry.probability, sizeof(bits));
    mix(entry.index);
    mix(bits);
  }
  return hash;
}

bool same(const std::vector<SparseEntry>& a, const std::vector<SparseEntry>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SparseEntry& x, const SparseEntry& y) {
    return x.index == y.index && x.probability == y.probability;
  });
}

double probabilityOf(const SparseRow& row, std::size_t index)
{
  const SparseEntry* found =
      std::lower_bound(row.begin(), row.end(), index,
                       [](const SparseEntry& entry, std::size_t i) { return entry.index < i; });
  return found != row.end() && found->index == index ? found->probability : 0.0;
}

}  // namespace

PolicyWalk::PolicyWalk(const Model& model, const Policy& policy, std::size_t max_bytes)
  : model_(model), policy_(policy), max_bytes_(max_bytes), predicted_(model.numStates(), 0.0)
{
}

PolicyWalk::Place* PolicyWalk::start(const Belief& belief)
{
  next_.clear();
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      next_.push_back({static_cast<std::uint32_t>(s), belief[s]});
    }
  }
  return placeOfNext();
}

PolicyWalk::Place* PolicyWalk::after(Place* from, std::size_t observation)
{
  for (const Place::Step& step : from->steps)
  {
    if (step.observation == observation)
    {
      return step.to;
    }
  }
  touched_.clear();
  for (const SparseEntry& state : from->belief)
  {
    for (const SparseEntry& next : model_.transitions(from->action, state.index))
    {
      if (predicted_[next.index] == 0.0)
      {
        touched_.push_back(next.index);
      }
      predicted_[next.index] += state.probability * next.probability;
    }
  }
  std::sort(touched_.begin(), touched_.end());
  next_.clear();
  double total = 0.0;
  for (std::size_t i = 0; i < touched_.size(); ++i)
  {
    const std::uint32_t s = touched_[i];
    const double p =
        predicted_[s] * probabilityOf(model_.observations(from->action, s), observation);
    predicted_[s] = 0.0;
    if (p > 0.0)
    {
      next_.push_back({s, p});
      total += p;
    }
  }
  if (!(total > 0.0))
  {
    throw FailedPrecondition("observation '" + model_.observationName(observation) +
                             "' is impossible after action '" + model_.actionName(from->action) +
                             "' at this belief");
  }
  for (SparseEntry& entry : next_)
  {
    entry.probability /= total;
  }
  Place* const to = placeOfNext();
  if (from->kept && to->kept)
  {
    from->steps.push_back({observation, to});
    bytes_ += sizeof(Place::Step);
  }
  return to;
}

PolicyWalk::Place* PolicyWalk::placeOfNext()
{
  const std::uint64_t hash = hashOf(next_);
  const auto [first, last] = by_belief_.equal_range(hash);
  for (auto known = first; known != last; ++known)
  {
    if (same(known->second->belief, next_))
    {
      return known->second;
    }
  }
  if (bytes_ >= max_bytes_)
  {
    Place& place = passing_[turn_ ^= 1U];
    place.belief.assign(next_.begin(), next_.end());
    place.action = actionAtNext();
    return &place;
  }
  Place& place = kept_.emplace_back();
  place.belief = next_;
  place.action = actionAtNext();
  place.kept = true;
  by_belief_.emplace(hash, &place);
  constexpr std::size_t kNodeOverhead = 64;  // of the index
  bytes_ += sizeof(Place) + kNodeOverhead + next_.size() * sizeof(SparseEntry);
  return &place;
}

std::size_t PolicyWalk::actionAtNext()
{
  std::vector<double> dense(model_.numStates(), 0.0);
  for (const SparseEntry& entry : next_)
  {
    dense[entry.index] = entry.probability;
  }
  return policy_.actionAt(Belief(std::move(dense)));
}

}  // namespace kr3::pomdp
