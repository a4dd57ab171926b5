#include "end_components.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace kr3::pomdp
{

namespace
{

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::vector<bool> finishedStates(const Model& model, const std::vector<std::uint32_t>& states)
{
  std::vector<bool> finished(model.numStates(), false);
  for (const std::uint32_t s : states)
  {
    bool earns = false;
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      earns = earns || model.reward(a, s) != 0.0;
    }
    finished[s] = !earns;
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const std::uint32_t s : states)
    {
      bool leaves = false;
      for (std::size_t a = 0; a < model.numActions() && finished[s] && !leaves; ++a)
      {
        for (const SparseEntry& next : model.transitions(a, s))
        {
          leaves = leaves || !finished[next.index];
        }
      }
      if (leaves)
      {
        finished[s] = false;
        changed = true;
      }
    }
  }
  return finished;
}

/// Strongly connected components of the states under the actions that are kept (Tarjan, without
/// recursion: chains of states may be long).
class Components
{
public:
  Components(const Model& model, const std::vector<bool>& keeps)
    : model_(&model)
    , keeps_(&keeps)
    , number_(model.numStates(), kNone)
    , low_(model.numStates(), 0)
    , component_(model.numStates(), kNone)
  {
  }

  std::vector<std::uint32_t> of(const std::vector<std::uint32_t>& states)
  {
    for (const std::uint32_t s : states)
    {
      if (number_[s] == kNone)
      {
        visit(s);
      }
    }
    return std::move(component_);
  }

private:
  /// A state on the way, and which of its outcomes is next.
  struct Visit
  {
    std::uint32_t state;
    std::size_t action = 0;
    std::size_t entry = 0;
  };

  void visit(std::uint32_t first)
  {
    std::vector<Visit> way;
    open(first, way);
    while (!way.empty())
    {
      Visit& here = way.back();
      const std::uint32_t next = nextOf(here);
      if (next == kNone)
      {
        close(way);
      }
      else if (number_[next] == kNone)
      {
        open(next, way);
      }
      else if (component_[next] == kNone)
      {
        low_[here.state] = std::min(low_[here.state], number_[next]);
      }
    }
  }

  void open(std::uint32_t state, std::vector<Visit>& way)
  {
    number_[state] = low_[state] = count_++;
    pending_.push_back(state);
    way.push_back({state});
  }

  void close(std::vector<Visit>& way)
  {
    const std::uint32_t state = way.back().state;
    way.pop_back();
    if (!way.empty())
    {
      std::uint32_t& low = low_[way.back().state];
      low = std::min(low, low_[state]);
    }
    if (low_[state] == number_[state])
    {
      std::uint32_t member = kNone;
      do
      {
        member = pending_.back();
        pending_.pop_back();
        component_[member] = state;
      } while (member != state);
    }
  }

  std::uint32_t nextOf(Visit& here) const
  {
    for (; here.action < model_->numActions(); ++here.action, here.entry = 0)
    {
      const SparseRow row = model_->transitions(here.action, here.state);
      if ((*keeps_)[here.action * model_->numStates() + here.state] && here.entry < row.size())
      {
        return row.begin()[here.entry++].index;
      }
    }
    return kNone;
  }

  const Model* model_;
  const std::vector<bool>* keeps_;
  std::vector<std::uint32_t> number_;
  std::vector<std::uint32_t> low_;
  std::vector<std::uint32_t> component_;
  std::vector<std::uint32_t> pending_;
  std::uint32_t count_ = 0;
};

}  // namespace

EndComponents endComponents(const Model& model, std::vector<std::uint32_t> states)
{
  EndComponents result{std::move(states), {}, {}, {}};
  result.finished = finishedStates(model, result.states);
  result.keeps.assign(model.numActions() * model.numStates(), false);
  for (const std::uint32_t s : result.states)
  {
    for (std::size_t a = 0; a < model.numActions() && !result.finished[s]; ++a)
    {
      result.keeps[a * model.numStates() + s] = true;
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    result.component = Components(model, result.keeps).of(result.states);
    for (const std::uint32_t s : result.states)
    {
      for (std::size_t a = 0; a < model.numActions(); ++a)
      {
        const std::size_t pair = a * model.numStates() + s;
        const SparseRow row = model.transitions(a, s);
        const bool stays = std::all_of(row.begin(), row.end(), [&](const SparseEntry& next) {
          return result.component[next.index] == result.component[s];
        });
        if (result.keeps[pair] && !stays)
        {
          result.keeps[pair] = false;
          changed = true;
        }
      }
    }
  }
  return result;
}

}  // namespace kr3::pomdp
