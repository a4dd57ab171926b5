#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace kr3::perception
{

/// 1 / (1 + exp(-w.x))
/// @throws InvalidArgument  different lengths
[[nodiscard]] double logistic(const std::vector<double>& weights,
                              const std::vector<double>& evidence);

/// Weights of the logistic regression with the greatest penalised likelihood, by Newton's method.
///
/// @param evidence  shape [samples][features]; the first feature should be 1 (the intercept)
/// @param truth     shape [samples]
/// @param penalty   of squared weights, > 0; keeps separable data finite
/// @throws InvalidArgument  no samples, or shapes differ
[[nodiscard]] std::vector<double> fitLogistic(const std::vector<std::vector<double>>& evidence,
                                              const std::vector<bool>& truth, double penalty);

}  // namespace kr3::perception
