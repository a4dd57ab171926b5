#include "domain_knowledge.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <unordered_set>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

const ReasonerOptions& checkedOptions(const ReasonerOptions& options)
{
  const auto& weights = options.default_weights;
  if (options.exception_weight < 1 || options.exogenous_weight < 1 ||
      std::any_of(weights.begin(), weights.end(),
                  [](const auto& named) { return named.second < 1; }))
  {
    throw InvalidArgument("found a price of an assumption below 1, expected at least 1");
  }
  if (options.window < 0 || options.max_combinations < 1 || options.max_carried_explanations < 1)
  {
    throw InvalidArgument(
        "found window " + std::to_string(options.window) + ", max_combinations " +
        std::to_string(options.max_combinations) + " and max_carried_explanations " +
        std::to_string(options.max_carried_explanations) + ", expected at least 0, 1 and 1");
  }
  return options;
}

}  // namespace

DomainKnowledge::DomainKnowledge(Description description, const ReasonerOptions& options)
  : description_(std::move(description))
  , symbols_(description_)
  , program_(description_, checkedOptions(options))
  , progression_({static_cast<std::size_t>(options.max_combinations),
                  static_cast<std::size_t>(options.max_carried_explanations)})
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

const Instances& DomainKnowledge::instances()
{
  if (!instances_)
  {
    instances_ = std::make_unique<Instances>(description_);
  }
  return *instances_;
}

const GroundRules& DomainKnowledge::groundRules()
{
  if (!ground_rules_)
  {
    ground_rules_ = std::make_unique<GroundRules>(description_);
  }
  return *ground_rules_;
}

ProblemSize DomainKnowledge::size(std::size_t num_records)
{
  if (!size_)
  {
    size_ = std::make_unique<ProblemSize>(sizeOf(description_));
  }
  ProblemSize size = *size_;
  size.records = num_records;
  return size;
}

ProblemSize sizeOf(const Description& description)
{
  ProblemSize size;
  std::unordered_set<std::string> constants;
  std::map<std::string, std::size_t> elements;
  for (const Sort& sort : description.sorts)
  {
    constants.insert(sort.elements.begin(), sort.elements.end());
    elements[sort.name] = sort.elements.size();
  }
  const auto count = [&](const std::vector<std::string>& sorts) {
    std::size_t product = 1;
    for (const std::string& sort : sorts)
    {
      product *= elements[sort];
    }
    return product;
  };
  for (const FluentDeclaration& fluent : description.fluents)
  {
    size.fluents += fluent.kind == FluentKind::kStatic ? 0 : count(fluent.argument_sorts);
  }
  for (const ActionDeclaration& action : description.actions)
  {
    size.actions += action.exogenous ? 0 : count(action.argument_sorts);
  }
  size.constants = constants.size();
  return size;
}

}  // namespace kr3::reasoner
