#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "exclusion_bound.hpp"
#include "noise_free_sensors.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::uint32_t kEnded = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMaxFineValues = 256;
constexpr std::size_t kMaxTable = 1U << 21U;  // sets times classes
constexpr std::size_t kMaxRows = 1U << 17U;   // of T: what is too large takes long to look at
constexpr double kTolerance = 1e-7;           // relative to the greatest value
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether no action leads out of the class's states, each of which keeps itself.
bool isSink(const StateClass& state_class, std::uint32_t c)
{
  for (const ClassAction& action : state_class.actions)
  {
    for (const Branch& branch : action.branches)
    {
      for (std::size_t s = 0; s < state_class.states.size(); ++s)
      {
        for (const SparseEntry& next : branch.joint.row(s))
        {
          if (branch.target_class != c || next.index != s)
          {
            return false;
          }
        }
      }
    }
  }
  return true;
}

/// Upper bounds of the states' values once they are known.
std::vector<double> cornersOf(const ObservedModel& model, const InformedVectors& informed)
{
  std::vector<double> corners(model.model().numStates(), 0.0);
  for (std::size_t c = 0; c < model.classes().size(); ++c)
  {
    const std::vector<std::uint32_t>& states = model.classes()[c].states;
    for (std::size_t i = 0; i < states.size(); ++i)
    {
      double greatest = -kInfinity;
      for (const std::vector<double>& vector : informed[c])
      {
        greatest = std::max(greatest, vector[i]);
      }
      corners[states[i]] = greatest;
    }
  }
  return corners;
}

}  // namespace

/// Finds the hidden values of the noise-free model and fills an ExclusionBound.
class ExclusionBound::Builder
{
public:
  Builder(const ObservedModel& real, const InformedVectors& informed,
          const std::function<bool()>& keep_going, std::size_t most_values)
    : real_(real)
    , most_values_(most_values)
    , clean_model_(withNoiseFreeSensors(real.model()))
    , clean_(clean_model_, true, keep_going)
    , corners_(cornersOf(real, informed))
  {
  }

  std::unique_ptr<ExclusionBound> build()
  {
    if (!findSearchClasses() || !findValues() || !groupValues())
    {
      return nullptr;
    }
    std::unique_ptr<ExclusionBound> bound(new ExclusionBound);
    bound_ = bound.get();
    bound_->num_sets_ = Set{1} << num_values_;
    for (const double corner : corners_)
    {
      bound_->tolerance_ = std::max(bound_->tolerance_, kTolerance * std::abs(corner));
    }
    findPriors();
    fillClasses();
    fillViews();
    return bound;
  }

private:
  /// Numbers the classes where the robot does not know all and something can still happen.
  bool findSearchClasses()
  {
    std::uint32_t count = 0;
    for (std::uint32_t c = 0; c < clean_.classes().size(); ++c)
    {
      const StateClass& state_class = clean_.classes()[c];
      const bool ended =
          state_class.states.size() == 1 || state_class.start_only || isSink(state_class, c);
      number_.push_back(ended ? kEnded : count++);
      if (!ended && state_class.states.size() > kMaxFineValues)
      {
        return false;
      }
    }
    num_search_classes_ = count;
    return count > 0;
  }

  /// States of search classes that lead to each other have the same hidden value; it is one that
  /// stays if no class has two states of a value.
  bool findValues()
  {
    std::vector<std::uint32_t> parent(clean_model_.numStates());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto find = [&parent](std::uint32_t s) {
      while (parent[s] != s)
      {
        s = parent[s] = parent[parent[s]];
      }
      return s;
    };
    forEachSearchState([&](std::uint32_t c, std::uint32_t i, std::uint32_t s) {
      for (const ClassAction& action : clean_.classes()[c].actions)
      {
        for (const Branch& branch : action.branches)
        {
          for (const SparseEntry& next : branch.joint.row(i))
          {
            if (number_[branch.target_class] != kEnded)
            {
              parent[find(s)] = find(clean_.classes()[branch.target_class].states[next.index]);
            }
          }
        }
      }
    });
    std::map<std::uint32_t, std::uint32_t> value_of;
    std::set<std::pair<std::uint32_t, std::uint32_t>> present;
    bool stays = true;
    values_.assign(clean_model_.numStates(), 0);
    forEachSearchState([&](std::uint32_t c, std::uint32_t /*i*/, std::uint32_t s) {
      const auto next = static_cast<std::uint32_t>(value_of.size());
      values_[s] = value_of.emplace(find(s), next).first->second;
      stays = stays && present.emplace(c, values_[s]).second;
    });
    num_values_ = value_of.size();
    return stays && num_values_ > 1 && num_values_ <= kMaxFineValues;
  }

  /// Makes one value of several where there are too many: those that earn alike.
  bool groupValues()
  {
    const std::size_t num_fine = num_values_;
    std::size_t most = std::min(most_values_, num_fine);
    while (most > 1 && (num_search_classes_ << most) > kMaxTable)
    {
      --most;
    }
    std::vector<double> earned(num_fine, 0.0);
    forEachSearchState([&](std::uint32_t c, std::uint32_t i, std::uint32_t s) {
      for (const ClassAction& action : clean_.classes()[c].actions)
      {
        earned[values_[s]] += action.rewards[i];
      }
    });
    std::vector<std::uint32_t> order(num_fine);
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return earned[a] < earned[b]; });
    std::vector<std::vector<std::uint32_t>> groups;
    for (const std::uint32_t value : order)
    {
      groups.push_back({value});
    }
    while (groups.size() > std::max<std::size_t>(most, 1))
    {
      std::size_t nearest = 0;
      double least = kInfinity;
      for (std::size_t g = 0; g + 1 < groups.size(); ++g)
      {
        const double size = static_cast<double>(groups[g].size() + groups[g + 1].size());
        const double difference =
            size * (1.0 + earned[groups[g + 1].back()] - earned[groups[g].front()]);
        if (difference < least)
        {
          least = difference;
          nearest = g;
        }
      }
      groups[nearest].insert(groups[nearest].end(), groups[nearest + 1].begin(),
                             groups[nearest + 1].end());
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(nearest) + 1);
    }
    group_of_.assign(num_fine, 0);
    for (std::uint32_t g = 0; g < groups.size(); ++g)
    {
      group_size_.push_back(groups[g].size());
      for (const std::uint32_t value : groups[g])
      {
        group_of_[value] = g;
      }
    }
    num_values_ = groups.size();
    return num_values_ > 1;
  }

  /// Any weights will do for a bound; those of the start make it tight.
  void findPriors()
  {
    priors_.assign(group_of_.size(), 0.0);
    forEachSearchState([&](std::uint32_t /*c*/, std::uint32_t /*i*/, std::uint32_t s) {
      priors_[values_[s]] += clean_model_.initialBelief()[s];
    });
    bound_->prior_.assign(num_values_, 0.0);
    for (std::size_t v = 0; v < priors_.size(); ++v)
    {
      priors_[v] = priors_[v] > 0.0 ? priors_[v] : 1.0 / static_cast<double>(priors_.size());
      bound_->prior_[group_of_[v]] += priors_[v];
    }
  }

  void fillClasses()
  {
    bound_->classes_.resize(num_search_classes_);
    std::map<std::vector<std::tuple<double, Set, std::uint32_t>>, std::uint32_t> futures;
    for (std::size_t c = 0; c < clean_.classes().size(); ++c)
    {
      if (number_[c] == kEnded)
      {
        continue;
      }
      const StateClass& from = clean_.classes()[c];
      SearchClass& to = bound_->classes_[number_[c]];
      to.optima.assign(bound_->num_sets_, 0.0);
      to.corners.assign(num_values_, 0.0);
      std::vector<std::size_t> present(num_values_, 0);
      for (const std::uint32_t s : from.states)
      {
        const std::uint32_t group = group_of_[values_[s]];
        to.corners[group] += priors_[values_[s]] * corners_[s];
        to.possible |= ++present[group] == group_size_[group] ? Set{1} << group : Set{0};
      }
      for (const ClassAction& action : from.actions)
      {
        to.actions.push_back(searchAction(from, action, futures));
      }
    }
  }

  template <typename Futures>
  SearchAction searchAction(const StateClass& from, const ClassAction& action, Futures& futures)
  {
    std::vector<double> rewards(num_values_, 0.0);
    std::vector<Outcome> outcomes;
    for (std::size_t s = 0; s < from.states.size(); ++s)
    {
      const std::uint32_t value = values_[from.states[s]];
      rewards[group_of_[value]] += priors_[value] * action.rewards[s];
    }
    for (const Branch& branch : action.branches)
    {
      addBranch(from, branch, rewards, outcomes);
    }
    std::vector<std::tuple<double, Set, std::uint32_t>> key;
    key.reserve(outcomes.size());
    for (const Outcome& outcome : outcomes)
    {
      key.emplace_back(outcome.weight, outcome.kept, outcome.target);
    }
    const auto next = static_cast<std::uint32_t>(futures.size());
    const auto [found, inserted] = futures.emplace(std::move(key), next);
    if (inserted)
    {
      bound_->futures_.push_back(std::move(outcomes));
    }
    double common = rewards.front() / bound_->prior_.front();
    for (std::size_t g = 0; g < num_values_; ++g)
    {
      if (std::abs(rewards[g] / bound_->prior_[g] - common) > 1e-12 * std::abs(common))
      {
        common = std::numeric_limits<double>::quiet_NaN();
        break;
      }
    }
    return {std::move(rewards), found->second, common};
  }

  /// A group whose values an outcome treats differently is told its value, which ends the search.
  /// An outcome that is less likely for some groups leaves a belief that is no set's: it is bounded
  /// by layers, as any belief is.
  void addBranch(const StateClass& from, const Branch& branch, std::vector<double>& rewards,
                 std::vector<Outcome>& outcomes) const
  {
    const double discount = clean_.discount();
    const std::uint32_t target = number_[branch.target_class];
    const std::vector<std::uint32_t>& targets = clean_.classes()[branch.target_class].states;
    std::vector<double> least(num_values_, kInfinity);
    std::vector<double> greatest(num_values_, 0.0);
    std::vector<std::size_t> present(num_values_, 0);
    std::vector<double> told(num_values_, 0.0);
    for (std::size_t s = 0; s < from.states.size(); ++s)
    {
      const std::uint32_t value = values_[from.states[s]];
      const std::uint32_t group = group_of_[value];
      double probability = 0.0;
      for (const SparseEntry& next : branch.joint.row(s))
      {
        probability += next.probability;
        told[group] += discount * priors_[value] * next.probability * corners_[targets[next.index]];
      }
      least[group] = std::min(least[group], probability);
      greatest[group] = std::max(greatest[group], probability);
      ++present[group];
    }
    std::map<double, Set, std::greater<>> by_probability;
    for (std::uint32_t g = 0; g < num_values_; ++g)
    {
      const bool whole = present[g] == group_size_[g] && greatest[g] - least[g] < 1e-12;
      if (target == kEnded || !whole)
      {
        rewards[g] += told[g];
      }
      else if (greatest[g] > 0.0)
      {
        by_probability[greatest[g]] |= Set{1} << g;
      }
    }
    Set kept = 0;
    for (auto level = by_probability.begin(); level != by_probability.end(); ++level)
    {
      kept |= level->second;
      const auto next = std::next(level);
      const double drop = level->first - (next == by_probability.end() ? 0.0 : next->first);
      outcomes.push_back({discount * drop, kept, target});
    }
  }

  void fillViews()
  {
    std::vector<std::uint32_t> class_of(clean_model_.numStates(), kEnded);
    forEachSearchState([&](std::uint32_t c, std::uint32_t /*i*/, std::uint32_t s) {
      const bool whole = (bound_->classes_[number_[c]].possible >> group_of_[values_[s]] & 1U) != 0;
      class_of[s] = whole ? number_[c] : kEnded;
    });
    for (const StateClass& state_class : real_.classes())
    {
      View view;
      std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Member>> held;
      for (std::uint32_t i = 0; i < state_class.states.size(); ++i)
      {
        const std::uint32_t s = state_class.states[i];
        if (class_of[s] == kEnded)
        {
          view.ended.push_back({i, 0.0, corners_[s]});
        }
        else
        {
          held[{class_of[s], group_of_[values_[s]]}].push_back(
              {i, priors_[values_[s]], corners_[s]});
        }
      }
      for (auto& [place, members] : held)
      {
        view.held.push_back({place.first, place.second, std::move(members)});
      }
      bound_->views_.push_back(std::move(view));
    }
  }

  /// Calls visit(class, index in the class, state).
  template <typename Visit>
  void forEachSearchState(const Visit& visit) const
  {
    for (std::uint32_t c = 0; c < clean_.classes().size(); ++c)
    {
      const std::vector<std::uint32_t>& states = clean_.classes()[c].states;
      for (std::uint32_t i = 0; number_[c] != kEnded && i < states.size(); ++i)
      {
        visit(c, i, states[i]);
      }
    }
  }

  const ObservedModel& real_;
  std::size_t most_values_;
  Model clean_model_;
  ObservedModel clean_;
  std::vector<double> corners_;  // by state: an upper bound once it is known
  ExclusionBound* bound_ = nullptr;
  std::vector<std::uint32_t> number_;  // of the search class, by class
  std::vector<std::uint32_t> values_;  // the hidden value, by state
  std::vector<double> priors_;         // by value
  std::vector<std::uint32_t> group_of_;
  std::vector<std::size_t> group_size_;
  std::size_t num_search_classes_ = 0;
  std::size_t num_values_ = 0;
};

std::unique_ptr<ExclusionBound> ExclusionBound::make(const ObservedModel& real,
                                                     const InformedVectors& informed,
                                                     const std::function<bool()>& keep_going,
                                                     std::size_t most_values)
{
  if (real.model().numStates() * real.numActions() > kMaxRows)
  {
    return nullptr;
  }
  try
  {
    return Builder(real, informed, keep_going, most_values).build();
  }
  catch (const Abandoned&)
  {
    return nullptr;
  }
}

}  // namespace kr3::pomdp
