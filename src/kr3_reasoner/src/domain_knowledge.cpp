#include "domain_knowledge.hpp"

#include <algorithm>
#include <chrono>
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

DomainKnowledge::Question::Question(DomainKnowledge& knowledge, const Limits& limits,
                                    const char* name)
  : knowledge_(knowledge)
{
  if (knowledge_.num_questions_++ > 0)
  {
    return;
  }
  SearchLimit limit;
  limit.cancel = limits.cancel;
  limit.question = name;
  if (limits.time_limit.count() > 0)
  {
    limit.deadline = std::chrono::steady_clock::now() + limits.time_limit;
  }
  knowledge_.program_.limitTo(limit);
}

DomainKnowledge::Question::~Question()
{
  if (--knowledge_.num_questions_ == 0)
  {
    knowledge_.program_.limitTo({});
  }
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
