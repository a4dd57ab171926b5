#include "domain_knowledge.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

const ReasonerOptions& checkedPrices(const ReasonerOptions& options)
{
  const auto& weights = options.default_weights;
  if (options.exception_weight < 1 || options.exogenous_weight < 1 ||
      std::any_of(weights.begin(), weights.end(),
                  [](const auto& named) { return named.second < 1; }))
  {
    throw InvalidArgument("found a price of an assumption below 1, expected at least 1");
  }
  return options;
}

}  // namespace

DomainKnowledge::DomainKnowledge(Description description, const ReasonerOptions& options)
  : description_(std::move(description))
  , symbols_(description_)
  , program_(description_, checkedPrices(options))
  , instances_(description_)
{
}

const GroundRules& DomainKnowledge::groundRules()
{
  if (!ground_rules_)
  {
    ground_rules_ = std::make_unique<GroundRules>(description_);
  }
  return *ground_rules_;
}

}  // namespace kr3::reasoner
