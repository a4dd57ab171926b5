#include "observed_model.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace kr3::pomdp
{

namespace
{

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class UnionFind
{
public:
  explicit UnionFind(std::size_t size) : parent_(size)
  {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t i)
  {
    while (parent_[i] != i)
    {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  /// Whether they were apart.
  bool unite(std::uint32_t i, std::uint32_t j)
  {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
    return i != j;
  }

private:
  std::vector<std::uint32_t> parent_;
};

/// Asks now and then whether to go on.
class Poll
{
public:
  explicit Poll(const std::function<bool()>& keep_going) : keep_going_(&keep_going) {}
  /// @throws Abandoned
  void operator()()
  {
    if (++count_ % kEvery == 0 && *keep_going_ && !(*keep_going_)())
    {
      throw Abandoned{};
    }
  }

private:
  static constexpr std::size_t kEvery = 64;
  const std::function<bool()>* keep_going_;
  std::size_t count_ = 0;
};

std::vector<std::uint32_t> reachableStates(const Model& model, Poll& poll)
{
  std::vector<bool> seen(model.numStates(), false);
  std::vector<std::uint32_t> open;
  for (std::uint32_t s = 0; s < model.numStates(); ++s)
  {
    if (model.initialBelief()[s] > 0.0)
    {
      seen[s] = true;
      open.push_back(s);
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i)
  {
    poll();
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      for (const SparseEntry& next : model.transitions(a, open[i]))
      {
        if (!seen[next.index])
        {
          seen[next.index] = true;
          open.push_back(next.index);
        }
      }
    }
  }
  std::sort(open.begin(), open.end());
  return open;
}

/// The states that the robot may start in, by what it sees before its first action.
std::vector<std::vector<std::uint32_t>> startSupports(const Model& model)
{
  std::vector<std::vector<std::uint32_t>> supports;
  for (const InitialOutcome& outcome : model.initialOutcomes())
  {
    supports.emplace_back();
    for (std::uint32_t s = 0; s < model.numStates(); ++s)
    {
      if (outcome.belief[s] > 0.0)
      {
        supports.back().push_back(s);
      }
    }
  }
  return supports;
}

/// Merges until every class, action and observation leads into one class, and so does every start.
UnionFind partition(const Model& model, const std::vector<std::uint32_t>& states,
                    const std::vector<std::vector<std::uint32_t>>& starts, Poll& poll)
{
  UnionFind classes(model.numStates());
  std::vector<std::uint32_t> leads_to(model.numStates() * model.numObservations());
  const auto unite = [&](std::size_t action, std::uint32_t from, std::size_t row) {
    bool changed = false;
    for (const SparseEntry& next : model.transitions(action, from))
    {
      for (const SparseEntry& seen : model.observations(action, next.index))
      {
        std::uint32_t& target = leads_to[row * model.numObservations() + seen.index];
        target = target == kNone ? next.index : target;
        changed = classes.unite(target, next.index) || changed;
      }
    }
    return changed;
  };
  for (const std::vector<std::uint32_t>& start : starts)
  {
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      std::fill_n(leads_to.begin(), model.numObservations(), kNone);
      for (const std::uint32_t s : start)
      {
        poll();
        unite(a, s, 0);
      }
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      std::fill(leads_to.begin(), leads_to.end(), kNone);
      for (const std::uint32_t s : states)
      {
        poll();
        changed = unite(a, s, classes.find(s)) || changed;
      }
    }
  }
  return classes;
}

/// States that some action leads to.
std::vector<bool> enteredStates(const Model& model, const std::vector<std::uint32_t>& states,
                                Poll& poll)
{
  std::vector<bool> entered(model.numStates(), false);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (const std::uint32_t s : states)
    {
      poll();
      for (const SparseEntry& next : model.transitions(a, s))
      {
        entered[next.index] = true;
      }
    }
  }
  return entered;
}

/// One entry of a branch, with its row.
struct JointEntry
{
  std::size_t state;
  SparseEntry next;
};

SparseRows rowsOf(const std::vector<JointEntry>& entries, std::size_t num_rows)
{
  SparseRows rows;
  std::vector<SparseEntry> row;
  std::size_t i = 0;
  for (std::size_t state = 0; state < num_rows; ++state)
  {
    row.clear();
    for (; i < entries.size() && entries[i].state == state; ++i)
    {
      row.push_back(entries[i].next);
    }
    rows.append(row);
  }
  return rows;
}

}  // namespace

ObservedModel::ObservedModel(const Model& model, bool find_classes,
                             const std::function<bool()>& keep_going)
  : model_(&model)
{
  Poll poll(keep_going);
  const std::vector<std::uint32_t> states = reachableStates(model, poll);
  const std::vector<std::vector<std::uint32_t>> supports = startSupports(model);
  UnionFind unions = partition(model, states, supports, poll);
  if (!find_classes)
  {
    for (const std::uint32_t s : states)
    {
      unions.unite(states.front(), s);
    }
  }
  std::vector<bool> needed = enteredStates(model, states, poll);
  const auto inOneClass = [&unions](const std::vector<std::uint32_t>& support) {
    return std::all_of(support.begin(), support.end(), [&](std::uint32_t s) {
      return unions.find(s) == unions.find(support.front());
    });
  };
  for (const std::vector<std::uint32_t>& support : supports)
  {
    const bool is_one_class = inOneClass(support);
    for (const std::uint32_t s : support)
    {
      needed[s] = needed[s] || is_one_class;
    }
  }
  std::vector<std::uint32_t> class_of(model.numStates(), kNone);
  std::vector<std::uint32_t> local_of(model.numStates(), 0);
  std::vector<std::uint32_t> class_of_root(model.numStates(), kNone);
  for (const std::uint32_t s : states)
  {
    if (!needed[s])
    {
      continue;
    }
    std::uint32_t& index = class_of_root[unions.find(s)];
    if (index == kNone)
    {
      index = static_cast<std::uint32_t>(classes_.size());
      classes_.emplace_back();
    }
    class_of[s] = index;
    local_of[s] = static_cast<std::uint32_t>(classes_[index].states.size());
    classes_[index].states.push_back(s);
  }
  const std::vector<InitialOutcome> outcomes = model.initialOutcomes();
  for (std::size_t i = 0; i < supports.size(); ++i)
  {
    std::uint32_t state_class = class_of[supports[i].front()];
    if (!inOneClass(supports[i]))
    {
      state_class = static_cast<std::uint32_t>(classes_.size());
      classes_.push_back({supports[i], {}, true});
    }
    ObservedStart start{outcomes[i].probability, state_class, {}};
    for (const std::uint32_t s : classes_[state_class].states)
    {
      start.belief.push_back(outcomes[i].belief[s]);
    }
    starts_.push_back(std::move(start));
  }

  std::vector<std::uint32_t> branch_of(model.numObservations());
  for (StateClass& state_class : classes_)
  {
    state_class.actions.resize(model.numActions());
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      ClassAction& action = state_class.actions[a];
      std::fill(branch_of.begin(), branch_of.end(), kNone);
      std::vector<std::vector<JointEntry>> entries;  // [branch], by ascending state
      for (std::size_t i = 0; i < state_class.states.size(); ++i)
      {
        poll();
        const std::uint32_t s = state_class.states[i];
        action.rewards.push_back(model.reward(a, s));
        for (const SparseEntry& next : model.transitions(a, s))
        {
          for (const SparseEntry& seen : model.observations(a, next.index))
          {
            std::uint32_t& branch = branch_of[seen.index];
            if (branch == kNone)
            {
              branch = static_cast<std::uint32_t>(entries.size());
              entries.emplace_back();
              action.branches.push_back({class_of[next.index], {}});
            }
            entries[branch].push_back(
                {i, {local_of[next.index], next.probability * seen.probability}});
          }
        }
      }
      for (std::size_t b = 0; b < entries.size(); ++b)
      {
        action.branches[b].joint = rowsOf(entries[b], state_class.states.size());
      }
    }
  }
}

}  // namespace kr3::pomdp
