#include "logistic.hpp"

#include <cmath>
#include <numeric>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kMaxIterations = 100;
constexpr double kConverged = 1e-8;

double sigmoid(double x)
{
  return 1.0 / (1.0 + std::exp(-x));
}

}  // namespace

double logistic(const std::vector<double>& weights, const std::vector<double>& evidence)
{
  if (weights.size() != evidence.size())
    throw InvalidArgument("found " + std::to_string(evidence.size()) + " features for " +
                          std::to_string(weights.size()) + " weights");
  return sigmoid(std::inner_product(weights.begin(), weights.end(), evidence.begin(), 0.0));
}

std::vector<double> fitLogistic(const std::vector<std::vector<double>>& evidence,
                                const std::vector<bool>& truth, double penalty)
{
  if (evidence.empty() || evidence.size() != truth.size())
    throw InvalidArgument("found " + std::to_string(evidence.size()) + " samples with " +
                          std::to_string(truth.size()) + " truths, expected as many, at least one");
  const int n = static_cast<int>(evidence.front().size());
  cv::Mat weights = cv::Mat::zeros(n, 1, CV_64F);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration)
  {
    cv::Mat gradient = -penalty * weights;
    cv::Mat hessian = penalty * cv::Mat::eye(n, n, CV_64F);
    for (std::size_t i = 0; i < evidence.size(); ++i)
    {
      if (static_cast<int>(evidence[i].size()) != n)
        throw InvalidArgument("sample " + std::to_string(i) + " has another number of features");
      const cv::Mat x(n, 1, CV_64F, const_cast<double*>(evidence[i].data()));
      const double p = sigmoid(weights.dot(x));
      gradient += x * ((truth[i] ? 1.0 : 0.0) - p);
      hessian += x * x.t() * (p * (1.0 - p) + 1e-6);
    }
    cv::Mat step;
    cv::solve(hessian, gradient, step, cv::DECOMP_CHOLESKY);
    weights += step;
    if (cv::norm(step, cv::NORM_INF) < kConverged)
      break;
  }
  return {weights.begin<double>(), weights.end<double>()};
}

}  // namespace kr3::perception
