#pragma once

#include <vector>

namespace kr3::perception
{

/// One node of a decision tree. A leaf has no feature.
struct TreeNode
{
  int feature = -1;        ///< index into the evidence; -1 = leaf
  double threshold = 0.0;  ///< evidence[feature] <= threshold goes left
  int left = 0;            ///< index of a node of the same tree, after this one
  int right = 0;
  double value = 0.0;  ///< of a leaf: what it adds to the log odds
};
using Tree = std::vector<TreeNode>;  ///< the root comes first

/// Probability of "right" given numbers that speak for and against it: the logistic function of a
/// sum of small decision trees.
class BoostedTrees
{
public:
  /// Knows nothing: needs 0 features, says one half.
  BoostedTrees() = default;

  /// @param num_features  length of the evidence, >= 0
  /// @param log_odds      of the prior, finite
  /// @throws InvalidArgument  a node that points outside its tree, backwards, or at no feature
  BoostedTrees(int num_features, double log_odds, std::vector<Tree> trees);

  [[nodiscard]] int numFeatures() const { return num_features_; }
  [[nodiscard]] double logOdds() const { return log_odds_; }
  [[nodiscard]] const std::vector<Tree>& trees() const { return trees_; }

  /// @param evidence  shape [numFeatures()]
  /// @return (0, 1)
  /// @throws InvalidArgument  another number of features
  [[nodiscard]] double probability(const std::vector<double>& evidence) const;

private:
  int num_features_ = 0;
  double log_odds_ = 0.0;
  std::vector<Tree> trees_;
};

struct BoostingOptions
{
  int max_rounds = 300;         ///< trees, > 0
  int depth = 4;                ///< of a tree, > 0
  double shrinkage = 0.06;      ///< of each tree's step, (0, 1]
  double min_leaf_hessian = 3;  ///< sum of p (1 - p) in a leaf, at least: keeps leaves honest
  double penalty = 2.0;         ///< on the squares of leaf values, >= 0
};

/// Fits trees by gradient boosting of the log loss, each tree by second-order splits over 64
/// quantiles of every feature. How many trees is found by leaving out every fifth group; then all
/// samples are used. Deterministic.
///
/// @param evidence  shape [samples, features], finite
/// @param truth     shape [samples]
/// @param group     shape [samples]: samples of one group (an image) are left out together, >= 0
/// @throws InvalidArgument  no samples, shapes that differ, values that are not finite
/// Source: Friedman (2001), "Greedy function approximation", with the second-order step and penalty
/// of Chen and Guestrin (2016), "XGBoost", equations 5 to 7.
[[nodiscard]] BoostedTrees fitBoostedTrees(const std::vector<std::vector<double>>& evidence,
                                           const std::vector<bool>& truth,
                                           const std::vector<int>& group,
                                           const BoostingOptions& options = {});

}  // namespace kr3::perception
