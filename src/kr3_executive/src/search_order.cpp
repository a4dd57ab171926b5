#include "search_order.hpp"

#include <algorithm>
#include <limits>

namespace kr3::executive
{
namespace
{

constexpr double kLeastCost = 1e-3;         // s
constexpr double kLeastProbability = 1e-6;  // of a hypothesis that is worth a place in the order

struct Rated
{
  std::size_t hypothesis;
  Prospect prospect;
  double index;
};

class Order
{
public:
  Order(const std::vector<double>& probability, const ProspectOf& prospect)
    : probability_(probability), prospect_(prospect)
  {
  }

  /// Those of `left` that can be tested from there, the best first.
  [[nodiscard]] std::vector<Rated> rated(std::size_t from, const std::vector<std::size_t>& left)
  {
    std::vector<Rated> result;
    for (const std::size_t hypothesis : left)
    {
      const auto prospect = prospect_(from, hypothesis);
      if (prospect)
        result.push_back({hypothesis, *prospect, index(hypothesis, *prospect)});
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Rated& a, const Rated& b) { return a.index > b.index; });
    return result;
  }

  /// Expected seconds when `first` is tested first and the others by the greedy rule.
  [[nodiscard]] double expectedCost(const Rated& first, std::vector<std::size_t> left)
  {
    double unseen = 1.0;  // probability that nothing was found so far
    double cost_s = 0.0;
    double pass_s = 0.0;
    Rated next = first;
    for (;;)
    {
      const double found = probability_[next.hypothesis] * next.prospect.detection;
      cost_s += unseen * next.prospect.test_s + found * next.prospect.rest_s;
      pass_s += next.prospect.test_s;
      unseen = std::max(0.0, unseen - found);
      left.erase(std::find(left.begin(), left.end(), next.hypothesis));
      std::optional<Rated> best;
      for (const std::size_t hypothesis : left)
      {
        const auto prospect = prospect_(next.prospect.end, hypothesis);
        if (!prospect)
          continue;
        const double value = index(hypothesis, *prospect);
        if (!best || value > best->index)
          best = Rated{hypothesis, *prospect, value};
      }
      if (!best)
        break;
      next = *best;
    }
    // What looking missed is looked for again, as long as that takes.
    return unseen < 1.0 ? cost_s + unseen * pass_s / (1.0 - unseen)
                        : std::numeric_limits<double>::infinity();
  }

private:
  [[nodiscard]] double index(std::size_t hypothesis, const Prospect& prospect) const
  {
    return probability_[hypothesis] * prospect.detection / std::max(prospect.test_s, kLeastCost);
  }

  const std::vector<double>& probability_;
  const ProspectOf& prospect_;
};

}  // namespace

Hypotheses hypothesesOf(const std::map<refinement::StateId, double>& belief)
{
  Hypotheses hypotheses;
  for (const auto& [state, probability] : belief)
  {
    hypotheses.states.push_back(state);
    hypotheses.probability.push_back(probability);
  }
  const auto& all = hypotheses.probability;
  hypotheses.likeliest =
      static_cast<std::size_t>(std::max_element(all.begin(), all.end()) - all.begin());
  return hypotheses;
}

std::optional<SearchChoice> firstToTest(const std::vector<double>& probability, std::size_t from,
                                        const ProspectOf& prospect,
                                        const SearchOrderOptions& options)
{
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < probability.size(); ++i)
  {
    if (probability[i] > kLeastProbability)
      all.push_back(i);
  }
  Order order(probability, prospect);
  const std::vector<Rated> rated = order.rated(from, all);
  if (rated.empty())
    return std::nullopt;
  if (all.size() > options.max_hypotheses)
  {
    const Rated& first = rated.front();
    return SearchChoice{first.hypothesis, first.prospect.test_s + first.prospect.rest_s};
  }
  std::optional<SearchChoice> best;
  for (std::size_t i = 0; i < std::min(options.candidates, rated.size()); ++i)
  {
    const double cost_s = order.expectedCost(rated[i], all);
    if (!best || cost_s < best->expected_s - kLeastCost)
      best = SearchChoice{rated[i].hypothesis, cost_s};
  }
  return best;
}

}  // namespace kr3::executive
