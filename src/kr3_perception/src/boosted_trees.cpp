#include "kr3_perception/boosted_trees.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr std::size_t kQuantiles = 64;
constexpr int kFolds = 5;
constexpr int kPatience = 30;  // rounds without a better loss on what was left out

double sigmoid(double x)
{
  return 1.0 / (1.0 + std::exp(-x));
}

double treeValue(const Tree& tree, const std::vector<double>& evidence)
{
  std::size_t i = 0;
  while (tree[i].feature >= 0)
    i = static_cast<std::size_t>(
        evidence[static_cast<std::size_t>(tree[i].feature)] <= tree[i].threshold ? tree[i].left
                                                                                 : tree[i].right);
  return tree[i].value;
}

/// Evidence as numbers of quantiles, column by column.
struct Binned
{
  std::vector<std::vector<double>> edges;     ///< per feature, ascending; bin b ends at edge b
  std::vector<std::vector<std::uint8_t>> of;  ///< shape [features, samples]
};

Binned binned(const std::vector<std::vector<double>>& evidence)
{
  const std::size_t num_features = evidence.front().size();
  Binned result;
  for (std::size_t f = 0; f < num_features; ++f)
  {
    std::vector<double> values;
    for (const std::vector<double>& sample : evidence)
      values.push_back(sample[f]);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> edges;
    for (std::size_t q = 1; q < kQuantiles; ++q)
    {
      const double edge = sorted[q * (sorted.size() - 1) / kQuantiles];
      if (edge < sorted.back() && (edges.empty() || edge > edges.back()))
        edges.push_back(edge);
    }
    std::vector<std::uint8_t> bins;
    for (const double value : values)
      bins.push_back(static_cast<std::uint8_t>(std::lower_bound(edges.begin(), edges.end(), value) -
                                               edges.begin()));
    result.edges.push_back(std::move(edges));
    result.of.push_back(std::move(bins));
  }
  return result;
}

/// First and second derivatives of the loss, summed.
struct Derivatives
{
  double first = 0.0;
  double second = 0.0;

  Derivatives& operator+=(const Derivatives& other)
  {
    first += other.first;
    second += other.second;
    return *this;
  }
  [[nodiscard]] Derivatives operator-(const Derivatives& other) const
  {
    return {first - other.first, second - other.second};
  }
  [[nodiscard]] double score(double penalty) const { return first * first / (second + penalty); }
};

struct Split
{
  int feature = -1;
  std::size_t bin = 0;
  double gain = 1e-6;
};

class TreeGrower
{
public:
  TreeGrower(const Binned& bins, const BoostingOptions& options) : bins_(bins), options_(options) {}

  Tree grow(const std::vector<Derivatives>& derivatives, const std::vector<std::size_t>& samples)
  {
    Tree tree;
    addNode(tree, derivatives, samples, 0);
    return tree;
  }

private:
  [[nodiscard]] Split bestSplit(const std::vector<Derivatives>& derivatives,
                                const std::vector<std::size_t>& samples,
                                const Derivatives& total) const
  {
    Split best;
    for (std::size_t f = 0; f < bins_.edges.size(); ++f)
    {
      std::vector<Derivatives> sums(bins_.edges[f].size() + 1);
      for (const std::size_t i : samples)
        sums[bins_.of[f][i]] += derivatives[i];
      Derivatives left;
      for (std::size_t bin = 0; bin + 1 < sums.size(); ++bin)
      {
        left += sums[bin];
        const Derivatives right = total - left;
        if (left.second < options_.min_leaf_hessian || right.second < options_.min_leaf_hessian)
          continue;
        const double gain = left.score(options_.penalty) + right.score(options_.penalty) -
                            total.score(options_.penalty);
        if (gain > best.gain)
          best = {static_cast<int>(f), bin, gain};
      }
    }
    return best;
  }

  int addNode(Tree& tree, const std::vector<Derivatives>& derivatives,
              const std::vector<std::size_t>& samples, int depth)
  {
    Derivatives total;
    for (const std::size_t i : samples)
      total += derivatives[i];
    const std::size_t index = tree.size();
    tree.emplace_back();
    tree[index].value = -options_.shrinkage * total.first / (total.second + options_.penalty);
    const Split split = depth < options_.depth ? bestSplit(derivatives, samples, total) : Split{};
    if (split.feature < 0)
      return static_cast<int>(index);
    const std::size_t f = static_cast<std::size_t>(split.feature);
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;
    for (const std::size_t i : samples)
      (bins_.of[f][i] <= split.bin ? left : right).push_back(i);
    const int left_index = addNode(tree, derivatives, left, depth + 1);
    const int right_index = addNode(tree, derivatives, right, depth + 1);
    tree[index].feature = split.feature;
    tree[index].threshold = bins_.edges[f][split.bin];
    tree[index].left = left_index;
    tree[index].right = right_index;
    tree[index].value = 0.0;
    return static_cast<int>(index);
  }

  const Binned& bins_;
  const BoostingOptions& options_;
};

struct Fit
{
  double log_odds = 0.0;
  std::vector<Tree> trees;
  std::size_t best_rounds = 0;  ///< on the samples that were left out
};

/// Boosts on `used`, and counts after how many rounds `left_out` was told best.
Fit boost(const std::vector<std::vector<double>>& evidence, const std::vector<bool>& truth,
          const Binned& bins, const std::vector<std::size_t>& used,
          const std::vector<std::size_t>& left_out, std::size_t max_rounds,
          const BoostingOptions& options)
{
  double right = 0.5;  // of one more sample of either kind: never 0 or 1
  for (const std::size_t i : used)
    right += truth[i] ? 1.0 : 0.0;
  const double share = right / (static_cast<double>(used.size()) + 1.0);
  Fit fit;
  fit.log_odds = std::log(share / (1.0 - share));
  std::vector<double> odds(evidence.size(), fit.log_odds);
  std::vector<Derivatives> derivatives(evidence.size());
  TreeGrower grower(bins, options);
  const auto lossLeftOut = [&] {
    double loss = 0.0;
    for (const std::size_t i : left_out)
      loss += std::log1p(std::exp(truth[i] ? -odds[i] : odds[i]));
    return loss;
  };
  double best_loss = lossLeftOut();
  for (std::size_t round = 1; round <= max_rounds; ++round)
  {
    for (const std::size_t i : used)
    {
      const double p = sigmoid(odds[i]);
      derivatives[i] = {p - (truth[i] ? 1.0 : 0.0), p * (1.0 - p)};
    }
    fit.trees.push_back(grower.grow(derivatives, used));
    for (std::size_t i = 0; i < evidence.size(); ++i)
      odds[i] += treeValue(fit.trees.back(), evidence[i]);
    if (left_out.empty())
      continue;
    const double loss = lossLeftOut();
    if (loss < best_loss)
    {
      best_loss = loss;
      fit.best_rounds = round;
    }
    else if (round > fit.best_rounds + kPatience)
      break;
  }
  return fit;
}

void checkSamples(const std::vector<std::vector<double>>& evidence, const std::vector<bool>& truth,
                  const std::vector<int>& group)
{
  if (evidence.empty() || evidence.size() != truth.size() || evidence.size() != group.size())
    throw InvalidArgument("found " + std::to_string(evidence.size()) + " samples with " +
                          std::to_string(truth.size()) + " truths and " +
                          std::to_string(group.size()) + " groups, expected as many, at least one");
  for (std::size_t i = 0; i < evidence.size(); ++i)
  {
    if (evidence[i].size() != evidence.front().size())
      throw InvalidArgument("sample " + std::to_string(i) + " has " +
                            std::to_string(evidence[i].size()) + " features, expected " +
                            std::to_string(evidence.front().size()));
    for (const double value : evidence[i])
      if (!std::isfinite(value))
        throw InvalidArgument("sample " + std::to_string(i) + " has a feature that is not finite");
    if (group[i] < 0)
      throw InvalidArgument("sample " + std::to_string(i) + " is of group " +
                            std::to_string(group[i]) + ", expected >= 0");
  }
}

}  // namespace

BoostedTrees::BoostedTrees(int num_features, double log_odds, std::vector<Tree> trees)
  : num_features_(num_features), log_odds_(log_odds), trees_(std::move(trees))
{
  if (num_features < 0 || !std::isfinite(log_odds))
    throw InvalidArgument("found " + std::to_string(num_features) + " features and log odds of " +
                          std::to_string(log_odds) + ", expected >= 0 and a finite number");
  for (std::size_t t = 0; t < trees_.size(); ++t)
  {
    const int size = static_cast<int>(trees_[t].size());
    if (size == 0)
      throw InvalidArgument("tree " + std::to_string(t) + " is empty");
    for (int i = 0; i < size; ++i)
    {
      const TreeNode& node = trees_[t][static_cast<std::size_t>(i)];
      const bool leaf = node.feature < 0;
      if (!std::isfinite(node.value) || !std::isfinite(node.threshold) ||
          node.feature >= num_features ||
          (!leaf && (node.left <= i || node.left >= size || node.right <= i || node.right >= size)))
        throw InvalidArgument("node " + std::to_string(i) + " of tree " + std::to_string(t) +
                              " points outside");
    }
  }
}

double BoostedTrees::probability(const std::vector<double>& evidence) const
{
  if (static_cast<int>(evidence.size()) != num_features_)
    throw InvalidArgument("found " + std::to_string(evidence.size()) + " features, expected " +
                          std::to_string(num_features_));
  double odds = log_odds_;
  for (const Tree& tree : trees_)
    odds += treeValue(tree, evidence);
  return sigmoid(odds);
}

BoostedTrees fitBoostedTrees(const std::vector<std::vector<double>>& evidence,
                             const std::vector<bool>& truth, const std::vector<int>& group,
                             const BoostingOptions& options)
{
  checkSamples(evidence, truth, group);
  const Binned bins = binned(evidence);
  std::vector<std::size_t> all(evidence.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::size_t rounds = 0;
  for (int fold = 0; fold < kFolds; ++fold)
  {
    std::vector<std::size_t> used;
    std::vector<std::size_t> left_out;
    for (const std::size_t i : all)
      (group[i] % kFolds == fold ? left_out : used).push_back(i);
    if (!used.empty() && !left_out.empty())
      rounds += boost(evidence, truth, bins, used, left_out,
                      static_cast<std::size_t>(options.max_rounds), options)
                    .best_rounds;
  }
  Fit fit = boost(evidence, truth, bins, all, {}, rounds / kFolds, options);
  return {static_cast<int>(evidence.front().size()), fit.log_odds, std::move(fit.trees)};
}

}  // namespace kr3::perception
