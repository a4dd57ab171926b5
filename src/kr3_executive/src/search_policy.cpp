#include "search_policy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kMostLooks = 8;  // at one hypothesis, each speaking for it
constexpr double kTolerance = 1e-7;    // of a sweep, as a part of the greatest value
constexpr int kMostSweeps = 2000;

/// Does an action; goes on by whether the expected observation came.
struct Node
{
  std::size_t action = 0;
  std::size_t expected = kNone;  ///< observation; kNone: whatever comes
  std::size_t hit = kNone;       ///< node, kNone: nothing more is earned
  std::size_t miss = kNone;
};

double likelihoodOf(const pomdp::Model& model, std::size_t action, std::size_t state,
                    std::size_t observation)
{
  for (const auto& entry : model.observations(action, state))
  {
    if (entry.index == observation)
      return entry.probability;
  }
  return 0.0;
}

class StateController
{
public:
  StateController(const FlatModel& flat, TestPlan& plan, double threshold)
    : flat_(flat), plan_(plan), threshold_(threshold)
  {
    finish_ = add({flat.finishAction(), kNone, kNone, kNone});
  }

  /// @param probability  of each hypothesis of the order
  /// @return whether each could be tested, and all states are in the model
  bool build(std::size_t place, const std::vector<std::uint32_t>& order,
             const std::vector<double>& probability)
  {
    std::size_t at = place;
    std::vector<std::size_t> gaps;  // nodes whose way on leads to the next hypothesis
    std::size_t first_test = kNone;
    for (std::size_t i = 0; i < order.size(); ++i)
    {
      const TestPlan::Parts parts{static_cast<std::uint32_t>(at), order[i]};
      const auto begin = plan_.state(parts);
      const auto test = begin ? plan_.testFrom(*begin) : std::nullopt;
      if (!test || test->steps.empty())
        return false;
      const std::size_t entry = nodes_.size();
      if (!addWay(*test, test->steps.size() - 1, kNone))
        return false;
      const std::size_t look = nodes_.size();
      for (const std::size_t gap : gaps)
        nodes_[gap].miss = entry;
      gaps = addTest(*test, order[(i + 1) % order.size()], probability[i]);
      if (gaps.empty())
        return false;
      first_test = i == 0 ? look : first_test;
      at = plan_.parts(test->endFrom(*begin)).place;
    }
    return close(at, order.front(), first_test, gaps);
  }

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }

  [[nodiscard]] pomdp::Policy policy() const
  {
    const auto& model = flat_.model;
    std::vector<std::vector<double>> values(nodes_.size());
    for (auto& of_node : values)
    {
      of_node.assign(model.numStates(), 0.0);
      for (std::size_t state = 0; state < model.numStates(); ++state)
        of_node[state] = model.reward(flat_.finishAction(), state);
    }
    double scale = 1.0;
    for (const double value : values.front())
      scale = std::max(scale, std::abs(value));
    double change = scale;
    for (int sweep = 0; sweep < kMostSweeps && change > kTolerance * scale; ++sweep)
    {
      change = 0.0;
      for (std::size_t node = nodes_.size(); node-- > 0;)
        change = std::max(change, evaluate(node, values));
    }
    const double slack = change / (1.0 - model.discount());
    std::vector<pomdp::AlphaVector> vectors;
    for (std::size_t node = 0; node < nodes_.size(); ++node)
    {
      for (double& value : values[node])
        value -= slack;
      vectors.push_back({nodes_[node].action, {}, std::move(values[node])});
    }
    return pomdp::Policy(model.numStates(), vectors);
  }

private:
  std::size_t add(const Node& node)
  {
    nodes_.push_back(node);
    return nodes_.size() - 1;
  }

  [[nodiscard]] std::size_t numberOf(StateId state) const
  {
    const auto found = flat_.number.find(state);
    return found == flat_.number.end() ? kNone : found->second;
  }

  /// The likeliest observation once a step led where it leads.
  [[nodiscard]] std::size_t expectedOf(const RouteStep& step) const
  {
    std::size_t best = kNone;
    double highest = 0.0;
    for (const auto& entry : flat_.model.observations(step.action, numberOf(step.next)))
    {
      if (entry.probability > highest)
      {
        highest = entry.probability;
        best = entry.index;
      }
    }
    return best;
  }

  /// Steps of a route, each repeated until it turns out as expected.
  /// @param after  node behind them; kNone: the one that is added next
  bool addWay(const Route& route, std::size_t count, std::size_t after)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const RouteStep& step = route.steps[i];
      if (numberOf(step.next) == kNone)
        return false;
      const std::size_t self = nodes_.size();
      const std::size_t next = i + 1 == count && after != kNone ? after : self + 1;
      add({step.action, expectedOf(step), next, self});
    }
    return true;
  }

  /// Looks as often as it takes, then the way to the goal.
  /// @param other  hidden values of another hypothesis
  /// @return the nodes that lead on to the next hypothesis by `miss`; empty: it cannot be built
  std::vector<std::size_t> addTest(const Route& test, std::uint32_t other, double probability)
  {
    const RouteStep& last = test.steps.back();
    const std::size_t here = numberOf(last.next);
    const auto elsewhere = plan_.state({plan_.parts(last.next).place, other});
    if (here == kNone || !elsewhere || numberOf(*elsewhere) == kNone)
      return {};
    const std::size_t yes = expectedOf(last);
    const double right = likelihoodOf(flat_.model, last.action, here, yes);
    const double wrong = likelihoodOf(flat_.model, last.action, numberOf(*elsewhere), yes);
    std::vector<std::size_t> gaps;
    double believed = probability;
    for (std::size_t look = 0; look == 0 || (look < kMostLooks && believed <= threshold_); ++look)
    {
      gaps.push_back(add({last.action, yes, nodes_.size() + 1, kNone}));
      believed = believed * right / (believed * right + (1.0 - believed) * wrong);
    }
    const std::size_t last_look = gaps.back();
    const auto& rest = plan_.goalFrom(last.next);
    if (!rest)
      return {};
    if (rest->steps.empty())
    {
      nodes_[last_look].hit = finish_;
      return gaps;
    }
    const std::size_t first = nodes_.size();
    if (!addWay(*rest, rest->steps.size(), finish_))
      return {};
    nodes_[first].miss = last_look;
    return gaps;
  }

  /// From the last hypothesis back to the first.
  bool close(std::size_t place, std::uint32_t hidden, std::size_t first_test,
             const std::vector<std::size_t>& gaps)
  {
    const auto begin = plan_.state({static_cast<std::uint32_t>(place), hidden});
    const auto test = begin ? plan_.testFrom(*begin) : std::nullopt;
    if (!test || test->steps.empty())
      return false;
    const std::size_t entry = test->steps.size() > 1 ? nodes_.size() : first_test;
    for (const std::size_t gap : gaps)
      nodes_[gap].miss = entry;
    return addWay(*test, test->steps.size() - 1, first_test);
  }

  /// One backup of a node in all states. @return the greatest change
  double evaluate(std::size_t number, std::vector<std::vector<double>>& values) const
  {
    const auto& model = flat_.model;
    const Node& node = nodes_[number];
    const auto valueAfter = [&](std::size_t next, std::size_t state) {
      return next == kNone ? 0.0 : values[next][state];
    };
    double change = 0.0;
    for (std::size_t state = 0; state < model.numStates(); ++state)
    {
      double sum = 0.0;
      for (const auto& outcome : model.transitions(node.action, state))
      {
        const double expected =
            node.expected == kNone ? 1.0
                                   : likelihoodOf(model, node.action, outcome.index, node.expected);
        if (expected > 0.0)
          sum += outcome.probability * expected * valueAfter(node.hit, outcome.index);
        if (expected < 1.0)
          sum += outcome.probability * (1.0 - expected) * valueAfter(node.miss, outcome.index);
      }
      const double value = model.reward(node.action, state) + model.discount() * sum;
      change = std::max(change, std::abs(value - values[number][state]));
      values[number][state] = value;
    }
    return change;
  }

  const FlatModel& flat_;
  TestPlan& plan_;
  double threshold_;
  std::vector<Node> nodes_;
  std::size_t finish_ = kNone;
};

}  // namespace

std::optional<pomdp::Policy> searchPolicy(const FlatModel& flat, TestPlan& plan,
                                          const DomainBelief& start, double threshold,
                                          const SearchOrderOptions& options, std::size_t max_nodes)
{
  const Hypotheses now = hypothesesOf(start.states());
  std::vector<std::uint32_t> hidden;
  for (const StateId state : now.states)
    hidden.push_back(plan.parts(state).hidden);
  const std::size_t place = plan.parts(now.likeliestState()).place;
  const ProspectOf prospect = [&](std::size_t from, std::size_t hypothesis) {
    return plan.prospect({static_cast<std::uint32_t>(from), hidden[hypothesis]});
  };
  const auto found = orderOfTests(now.probability, place, prospect, options);
  if (!found || found->order.size() < 2)
    return std::nullopt;
  std::vector<std::uint32_t> order;
  std::vector<double> probability;
  for (const std::size_t hypothesis : found->order)
  {
    order.push_back(hidden[hypothesis]);
    probability.push_back(now.probability[hypothesis]);
  }
  StateController controller(flat, plan, threshold);
  if (!controller.build(place, order, probability) || controller.size() > max_nodes)
    return std::nullopt;
  return controller.policy();
}

}  // namespace kr3::executive
