#include "search_order.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace kr3::executive
{
namespace
{

constexpr double kLeastCost = 1e-3;         // s
constexpr double kLeastProbability = 1e-6;  // of a hypothesis that is worth a place in the order
/// What is less likely than so many parts of the likeliest was looked for before or need not be
/// yet. An order that had to have room for it would look again at once, to save the way back.
constexpr double kLikely = 0.3;
/// Places by which one test is moved, or between the ends of a part that is reversed: farther moves
/// are seldom better.
constexpr std::size_t kReach = 40;

struct Rated
{
  std::size_t hypothesis;
  Prospect prospect;
  float index;
};

/// Asks for prospects and counts.
class Prospects
{
public:
  Prospects(const std::vector<double>& probability, const ProspectOf& prospect)
    : probability_(probability), prospect_(prospect)
  {
  }

  [[nodiscard]] std::optional<Prospect> of(std::size_t from, std::size_t hypothesis)
  {
    ++count_;
    return prospect_(from, hypothesis);
  }
  [[nodiscard]] double probability(std::size_t hypothesis) const
  {
    return probability_[hypothesis];
  }
  /// In single precision, so that rounding decides between no two that are alike.
  [[nodiscard]] float index(std::size_t hypothesis, const Prospect& prospect) const
  {
    return static_cast<float>(probability_[hypothesis] * prospect.detection /
                              std::max(prospect.test_s, kLeastCost));
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

private:
  const std::vector<double>& probability_;
  const ProspectOf& prospect_;
  std::uint64_t count_ = 0;
};

/// Those of `left` that can be tested from there, the best first.
std::vector<Rated> rated(Prospects& prospects, std::size_t from,
                         const std::vector<std::size_t>& left)
{
  std::vector<Rated> result;
  for (const std::size_t hypothesis : left)
  {
    const auto prospect = prospects.of(from, hypothesis);
    if (prospect)
      result.push_back({hypothesis, *prospect, prospects.index(hypothesis, *prospect)});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Rated& a, const Rated& b) { return a.index > b.index; });
  return result;
}

/// A part of an order, then the others by the greedy rule, as far as they can be tested.
/// @param at    where the robot is after that part
/// @param left  the others
std::vector<std::size_t> extended(Prospects& prospects, std::vector<std::size_t> order,
                                  std::size_t at, std::vector<std::size_t> left)
{
  for (;;)
  {
    std::optional<Rated> best;
    for (const std::size_t hypothesis : left)
    {
      const auto prospect = prospects.of(at, hypothesis);
      if (!prospect)
        continue;
      const float value = prospects.index(hypothesis, *prospect);
      if (!best || value > best->index)
        best = Rated{hypothesis, *prospect, value};
    }
    if (!best)
      return order;
    order.push_back(best->hypothesis);
    at = best->prospect.end;
    left.erase(std::find(left.begin(), left.end(), best->hypothesis));
  }
}

/// Those of `all` that are not in a part of an order.
std::vector<std::size_t> without(const std::vector<std::size_t>& all,
                                 const std::vector<std::size_t>& part)
{
  std::vector<std::size_t> left;
  std::copy_if(all.begin(), all.end(), std::back_inserter(left), [&](std::size_t hypothesis) {
    return std::find(part.begin(), part.end(), hypothesis) == part.end();
  });
  return left;
}

/// An order with what it costs, place by place.
class Tour
{
public:
  Tour(Prospects& prospects, std::size_t start) : prospects_(prospects), places_{{start}} {}

  /// @return whether each can be tested from where the one before leaves the robot
  bool assign(std::vector<std::size_t> order)
  {
    order_ = std::move(order);
    return measureFrom(0);
  }

  [[nodiscard]] const std::vector<std::size_t>& order() const { return order_; }

  /// Expected seconds to the goal; what looking missed is looked for again, as long as that takes.
  [[nodiscard]] double expectedCost() const
  {
    const Place& end = places_.back();
    return end.unseen < 1.0 ? end.cost_s + again() * end.pass_s
                            : std::numeric_limits<double>::infinity();
  }

  /// Reverses parts and moves single tests while that helps.
  /// @param count  of the first tests, which are those that are moved
  void improve(std::size_t count, std::uint64_t max_prospects)
  {
    bool better = places_.back().unseen < 1.0;
    while (better)
    {
      better = false;
      for (std::size_t i = 0; i + 1 < count; ++i)
      {
        const std::size_t last = std::min(count - 1, i + kReach);
        for (std::size_t j = i + 1; j <= last; ++j)
        {
          for (const Change change : {Change::kReverse, Change::kLater, Change::kSooner})
          {
            if (prospects_.count() >= max_prospects)
              return;
            if (change != Change::kReverse && j == i + 1)
              continue;  // the same as reversing two
            better = tryChange(change, i, j) || better;
          }
        }
      }
    }
  }

private:
  /// Of the places i to j: turned round; the first behind the last; the last before the first.
  enum class Change
  {
    kReverse,
    kLater,
    kSooner,
  };

  /// Before a place of the order.
  struct Place
  {
    std::size_t at;       ///< where the robot is
    double unseen = 1.0;  ///< probability that nothing was found so far
    double cost_s = 0.0;  ///< expected, so far
    double pass_s = 0.0;  ///< when nothing is found, so far
  };

  [[nodiscard]] double again() const
  {
    const double unseen = places_.back().unseen;
    return unseen / (1.0 - unseen);
  }

  [[nodiscard]] std::optional<Place> after(const Place& place, std::size_t hypothesis)
  {
    const auto prospect = prospects_.of(place.at, hypothesis);
    if (!prospect)
      return std::nullopt;
    const double found = prospects_.probability(hypothesis) * prospect->detection;
    return Place{prospect->end, std::max(0.0, place.unseen - found),
                 place.cost_s + place.unseen * prospect->test_s + found * prospect->rest_s,
                 place.pass_s + prospect->test_s};
  }

  bool measureFrom(std::size_t first)
  {
    places_.resize(first + 1);
    for (std::size_t i = first; i < order_.size(); ++i)
    {
      const auto next = after(places_[i], order_[i]);
      if (!next)
        return false;
      places_.push_back(*next);
    }
    return true;
  }

  void rearrange(Change change, std::size_t i, std::size_t j)
  {
    const auto first = order_.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = order_.begin() + static_cast<std::ptrdiff_t>(j) + 1;
    if (change == Change::kReverse)
      std::reverse(first, end);
    else
      std::rotate(first, change == Change::kLater ? first + 1 : end - 1, end);
  }

  void rearrangeBack(Change change, std::size_t i, std::size_t j)
  {
    rearrange(change == Change::kLater    ? Change::kSooner
              : change == Change::kSooner ? Change::kLater
                                          : change,
              i, j);
  }

  /// Changes the order if that is better.
  bool tryChange(Change change, std::size_t i, std::size_t j)
  {
    rearrange(change, i, j);
    Place place = places_[i];
    std::size_t next = i;
    // Behind the part the rest costs as much as before, once the robot is where it was.
    while (next < order_.size() && (next <= j || place.at != places_[next].at))
    {
      const auto reached = after(place, order_[next]);
      if (!reached)
      {
        rearrangeBack(change, i, j);
        return false;
      }
      place = *reached;
      ++next;
    }
    const double more_s =
        place.cost_s - places_[next].cost_s + again() * (place.pass_s - places_[next].pass_s);
    if (more_s > -kLeastCost)
    {
      rearrangeBack(change, i, j);
      return false;
    }
    measureFrom(i);
    return true;
  }

  Prospects& prospects_;
  std::vector<std::size_t> order_;
  std::vector<Place> places_;  ///< one more than the order
};

/// The likely hypotheses of an order found before, then the others by the greedy rule.
std::vector<std::size_t> continued(Prospects& prospects, std::size_t from,
                                   const std::vector<std::size_t>& known,
                                   const std::vector<std::size_t>& all, double least)
{
  std::vector<std::size_t> order;
  std::size_t at = from;
  for (const std::size_t hypothesis : known)
  {
    if (std::find(all.begin(), all.end(), hypothesis) == all.end() ||
        prospects.probability(hypothesis) < least)
      continue;
    if (const auto prospect = prospects.of(at, hypothesis))
    {
      order.push_back(hypothesis);
      at = prospect->end;
    }
  }
  std::vector<std::size_t> left = without(all, order);
  return extended(prospects, std::move(order), at, std::move(left));
}

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

std::optional<SearchChoice> orderOfTests(const std::vector<double>& probability, std::size_t from,
                                         const ProspectOf& prospect,
                                         const SearchOrderOptions& options,
                                         const std::vector<std::size_t>& known)
{
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < probability.size(); ++i)
  {
    if (probability[i] > kLeastProbability)
      all.push_back(i);
  }
  Prospects prospects(probability, prospect);
  const std::vector<Rated> firsts = rated(prospects, from, all);
  if (firsts.empty())
    return std::nullopt;
  std::optional<Tour> best;
  const auto consider = [&](std::vector<std::size_t> order) {
    Tour tour(prospects, from);
    if (tour.assign(std::move(order)) &&
        (!best || tour.expectedCost() < best->expectedCost() - kLeastCost))
      best.emplace(std::move(tour));
  };
  for (std::size_t i = 0; i < std::min(options.candidates, firsts.size()); ++i)
  {
    if (i > 0 && prospects.count() >= options.max_prospects)
      break;
    const std::size_t first = firsts[i].hypothesis;
    consider(extended(prospects, {first}, firsts[i].prospect.end, without(all, {first})));
  }
  const double least = kLikely * *std::max_element(probability.begin(), probability.end());
  if (!known.empty())
    consider(continued(prospects, from, known, all, least));
  const auto unlikely =
      std::find_if(best->order().begin(), best->order().end(),
                   [&](std::size_t hypothesis) { return probability[hypothesis] < least; });
  best->improve(static_cast<std::size_t>(unlikely - best->order().begin()), options.max_prospects);
  return SearchChoice{best->order(), best->expectedCost(), prospects.count()};
}

}  // namespace kr3::executive
