// The services of reasoner_node: each converts, asks the reasoner, and converts back.

#include <algorithm>
#include <cstdint>
#include <utility>

#include <std_srvs/Trigger.h>

#include <kr3_common/ros/status.hpp>
#include <kr3_msgs/FindRelevant.h>
#include <kr3_msgs/FindRetractions.h>
#include <kr3_msgs/GetPossibleValues.h>
#include <kr3_msgs/ListModels.h>
#include <kr3_msgs/ProgressHistory.h>
#include <kr3_msgs/ReloadDomain.h>
#include <kr3_msgs/Translate.h>

#include "conversions.hpp"
#include "reasoner_node.hpp"
#include "texts.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr std::uint8_t kUnknown = kr3_msgs::Entails::Request::UNKNOWN;

static_assert(static_cast<int>(Answer::kFalse) == kr3_msgs::Entails::Request::FALSE);
static_assert(static_cast<int>(Answer::kTrue) == kr3_msgs::Entails::Request::TRUE);
static_assert(static_cast<int>(Answer::kUnknown) == kUnknown);

int stepOf(std::uint32_t step)
{
  return static_cast<int>(std::min<std::uint32_t>(step, 1000000));
}

const std::string& literalOf(const std::string& text)
{
  return checkedText(text, "literal");
}

/// What of a history does not fit the reasoner's description, a line for each record.
std::string misfits(const std::vector<Record>& history, Reasoner& reasoner)
{
  std::string problems;
  for (std::size_t i = 0; i < history.size(); ++i)
  {
    try
    {
      reasoner.setHistory({history[i]});
    }
    catch (const InvalidArgument& e)
    {
      problems += (problems.empty() ? "" : "\n") + std::string("record ") + std::to_string(i + 1) +
                  " of the history does not fit the files any more: " + e.what();
    }
  }
  return problems;
}

void fill(const Diagnosis& diagnosis, kr3_msgs::WhatIf::Response& response)
{
  response.consistent = static_cast<std::uint8_t>(diagnosis.consistent);
  response.cost = static_cast<std::uint32_t>(diagnosis.cost);
  response.conflict = diagnosis.conflict;
  response.alternatives = toMsgs<kr3_msgs::MinimalExplanation>(diagnosis.alternatives);
}

}  // namespace

template <typename Service>
void ReasonerNode::serve(
    ros::NodeHandle& nh, const std::string& name,
    std::function<void(const typename Service::Request&, typename Service::Response&)> answer)
{
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  const boost::function<bool(Request&, Response&)> callback =
      [this, name, answer = std::move(answer)](Request& request, Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const ros::WallTime start = ros::WallTime::now();
    respond(response.status, name, [&] {
      try
      {
        reasoner_.setLimits(questionLimits());
        answer(request, response);
      }
      catch (const Error& e)
      {
        throw Error(e.code(), printable(e.what()), e.where());
      }
    });
    ++num_questions_;
    last_question_ = name;
    last_time_ = ros::WallTime::now();
    last_duration_s_ = (last_time_ - start).toSec();
    return true;
  };
  services_.push_back(nh.advertiseService<Request, Response>("reasoner/" + name, callback));
}

void ReasonerNode::offerHistory(ros::NodeHandle& nh)
{
  serve<kr3_msgs::SetHistory>(nh, "set_history", [this](const auto& request, auto& response) {
    response.num_records = static_cast<std::uint32_t>(num_told_);
    checkCount(request.records.size());
    reasoner_.setHistory(fromMsg(request.records));
    num_told_ = request.records.size();
    response.num_records = static_cast<std::uint32_t>(num_told_);
  });
  serve<kr3_msgs::AddRecords>(nh, "add_records", [this](const auto& request, auto& response) {
    response.num_records = static_cast<std::uint32_t>(num_told_);
    addRecords(request);
    response.num_records = static_cast<std::uint32_t>(num_told_);
  });
  serve<kr3_msgs::ProgressHistory>(nh, "progress_history",
                                   [this](const auto& request, auto& response) {
    response.first_step = static_cast<std::uint32_t>(reasoner_.firstStep());
    response.num_records = static_cast<std::uint32_t>(reasoner_.history().size());
    const Progress progress = reasoner_.progress(stepOf(request.step));
    response.first_step = static_cast<std::uint32_t>(progress.first_step);
    response.num_records = static_cast<std::uint32_t>(progress.num_records);
    response.kept_because = progress.kept_because;
  });
  services_.push_back(nh.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
      "reasoner/get_options",
      [this](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    response.success = 1;
    response.message = jsonOf(config_.options);
    return true;
      }));
  serve<kr3_msgs::ReloadDomain>(nh, "reload_domain",
                                [this](const auto&, auto&) { reloadDomain(); });
}

void ReasonerNode::reloadDomain()
{
  if (reasoner_.firstStep() > 0)
  {
    throw FailedPrecondition("the history was progressed to step " +
                             std::to_string(reasoner_.firstStep()) +
                             " with the description that was read before; expected one that begins "
                             "at step 0 (set_history)");
  }
  Reasoner reasoner(readDomain(config_), config_.options);
  const std::string problems = misfits(reasoner_.history(), reasoner);
  if (!problems.empty())
  {
    throw InvalidArgument(problems);
  }
  reasoner.setHistory(reasoner_.history());
  reasoner_ = std::move(reasoner);
  planner_ = nullptr;
  ++domain_version_;
  ROS_INFO("read %s again", config_.domain.c_str());
}

void ReasonerNode::checkCount(std::size_t num_records) const
{
  if (num_records > static_cast<std::size_t>(config_.max_records))
  {
    throw ResourceExhausted("found a history of " + std::to_string(num_records) +
                            " records, expected at most " + std::to_string(config_.max_records) +
                            " (parameter max_records)");
  }
}

void ReasonerNode::addRecords(const kr3_msgs::AddRecords::Request& request)
{
  if (request.expected_num_records != num_told_)
  {
    throw FailedPrecondition(
        "there are " + std::to_string(num_told_) + " records, the client expected " +
        std::to_string(request.expected_num_records) + "; set the history again");
  }
  checkCount(reasoner_.history().size() + request.records.size());
  reasoner_.addRecords(fromMsg(request.records));
  num_told_ += request.records.size();
}

void ReasonerNode::offerQuestions(ros::NodeHandle& nh)
{
  serve<kr3_msgs::Entails>(nh, "entails", [this](const auto& request, auto& response) {
    const int step = stepOf(request.step);
    const std::string& literal = literalOf(request.literal);
    response.answer = static_cast<std::uint8_t>(reasoner_.entails(literal, step));
    response.possible = static_cast<std::uint8_t>(reasoner_.possible(literal, step));
  });
  serve<kr3_msgs::GetPossibleValues>(nh, "get_possible_values",
                                     [this](const auto& request, auto& response) {
    response.values =
        reasoner_.possibleValues(checkedText(request.fluent, "fluent"), stepOf(request.step));
  });
  serve<kr3_msgs::GetState>(nh, "get_state", [this](const auto& request, auto& response) {
    getState(request, response);
  });
  serve<kr3_msgs::ExplainLiteral>(
      nh, "explain", [this](const auto& request, auto& response) { explain(request, response); });
  serve<kr3_msgs::WhatIf>(
      nh, "what_if", [this](const auto& request, auto& response) { whatIf(request, response); });
}

void ReasonerNode::offerAnalyses(ros::NodeHandle& nh)
{
  serve<kr3_msgs::Diagnose>(
      nh, "diagnose", [this](const auto& request, auto& response) { diagnose(request, response); });
  serve<kr3_msgs::ListModels>(nh, "list_models", [this](const auto& request, auto& response) {
    constexpr std::uint32_t kDefaultLimit = 100;
    constexpr std::uint32_t kMaxLimit = 10000;
    const std::size_t limit =
        request.limit == 0 ? kDefaultLimit : std::min(request.limit, kMaxLimit);
    std::vector<HistoryModel> models = reasoner_.models(limit + 1);
    response.complete = static_cast<std::uint8_t>(models.size() <= limit);
    models.resize(std::min(models.size(), limit));
    for (const HistoryModel& model : models)
    {
      response.models.push_back(toMsg(model, reasoner_.description()));
    }
  });
  serve<kr3_msgs::FindRetractions>(nh, "find_retractions",
                                   [this](const auto& request, auto& response) {
    response.retractions = toMsgs<kr3_msgs::Retraction>(
        request.literal.empty()
            ? reasoner_.retractions()
            : reasoner_.retractionsFor(literalOf(request.literal), stepOf(request.step)));
  });
  serve<kr3_msgs::FindRelevant>(nh, "find_relevant", [this](const auto& request, auto& response) {
    const RelevantPart part = reasoner_.relevant(checkedText(request.goal, "goal"));
    response.constants = toMsgs<kr3_msgs::RelevantItem>(part.constants);
    response.fluents = toMsgs<kr3_msgs::RelevantItem>(part.fluents);
    response.actions = toMsgs<kr3_msgs::RelevantItem>(part.actions);
    response.records = toMsgs<kr3_msgs::HistoryRecord>(part.records);
    response.considered = toMsg(part.considered);
    response.whole = toMsg(part.whole);
  });
  serve<kr3_msgs::Translate>(nh, "translate", [this](const auto& request, auto& response) {
    response.program =
        request.goal.empty()
            ? reasoner_.translation()
            : reasoner_.translation(checkedText(request.goal, "goal"), stepOf(request.length));
  });
}

void ReasonerNode::diagnose(const kr3_msgs::Diagnose::Request& request,
                            kr3_msgs::Diagnose::Response& response) const
{
  const auto weight = [](std::uint32_t wanted, int otherwise) {
    return wanted == 0 ? otherwise : stepOf(wanted);
  };
  ReasonerOptions options = config_.options;
  options.diagnose_exogenous = options.diagnose_exogenous || request.exogenous != 0;
  options.exception_weight = weight(request.exception_weight, options.exception_weight);
  options.exogenous_weight = weight(request.exogenous_weight, options.exogenous_weight);
  const bool as_configured = options.diagnose_exogenous == config_.options.diagnose_exogenous &&
                             options.exception_weight == config_.options.exception_weight &&
                             options.exogenous_weight == config_.options.exogenous_weight;
  Diagnosis diagnosis;
  if (as_configured)
  {
    diagnosis = reasoner_.diagnose();
  }
  else
  {
    Reasoner other(reasoner_.description(), options);
    other.setLimits(questionLimits());
    other.follow(reasoner_);
    diagnosis = other.diagnose();
  }
  response.consistent = static_cast<std::uint8_t>(diagnosis.consistent);
  response.cost = static_cast<std::uint32_t>(diagnosis.cost);
  response.conflict = diagnosis.conflict;
  response.alternatives = toMsgs<kr3_msgs::MinimalExplanation>(diagnosis.alternatives);
  for (const std::vector<std::string>& explanation : diagnosis.explanations)
  {
    response.explanations.push_back(joined(explanation, "; "));
  }
  response.complete = static_cast<std::uint8_t>(diagnosis.complete);
  response.parts = toMsgs<kr3_msgs::ExplanationPart>(diagnosis.parts);
}

void ReasonerNode::explain(const kr3_msgs::ExplainLiteral::Request& request,
                           kr3_msgs::ExplainLiteral::Response& response) const
{
  const std::string& literal = literalOf(request.literal);
  const int step = stepOf(request.step);
  const Explanation explanation = reasoner_.explain(literal, step);
  response.entailed = static_cast<std::uint8_t>(explanation.entailed);
  response.reasons = explanation.reasons;
  response.records = explanation.records;
  response.record_indices.assign(explanation.record_indices.begin(),
                                 explanation.record_indices.end());
  response.defaults = explanation.defaults;
  if (explanation.entailed)
  {
    response.proof = toMsg(explanation.proof);
  }
  else if (reasoner_.possible(literal, step))
  {
    const OpenQuestion question = reasoner_.whyUnknown(literal, step);
    response.open = static_cast<std::uint8_t>(true);
    response.reasons = question.reasons;
    response.values = question.values;
    for (const std::string& fluent : question.deciding)
    {
      for (const std::string& value : reasoner_.possibleValues(fluent, reasoner_.currentStep()))
      {
        Record observation;
        observation.statement = fluent + " = " + value;
        observation.step = reasoner_.currentStep();
        response.deciding.push_back(toString(observation));
      }
    }
  }
}

void ReasonerNode::whatIf(const kr3_msgs::WhatIf::Request& request,
                          kr3_msgs::WhatIf::Response& response) const
{
  checkCount(reasoner_.history().size() + request.records.size());
  const Reasoner supposed = reasoner_.supposing(fromMsg(request.records));
  fill(supposed.diagnose(), response);
  response.answer = kUnknown;
  response.answer_without = kUnknown;
  if (request.literal.empty())
  {
    return;
  }
  const std::string& literal = literalOf(request.literal);
  const int step = stepOf(request.step);
  if (response.consistent == 0)
  {
    static_cast<void>(parseGroundLiteral(literal, reasoner_.description()));
    return;
  }
  response.answer = static_cast<std::uint8_t>(supposed.entails(literal, step));
  response.possible = static_cast<std::uint8_t>(supposed.possible(literal, step));
  if (step <= reasoner_.currentStep() && reasoner_.diagnose().consistent)
  {
    response.answer_without = static_cast<std::uint8_t>(reasoner_.entails(literal, step));
  }
}

void ReasonerNode::getState(const kr3_msgs::GetState::Request& request,
                            kr3_msgs::GetState::Response& response) const
{
  const int step = stepOf(request.step);
  for (const Literal& literal : reasoner_.entailedAt(step))
  {
    kr3_msgs::ExplainedLiteral explained;
    explained.literal = toString(literal, reasoner_.description());
    explained.step = request.step;
    if (request.explain != 0)
    {
      explained.reason = joined(reasoner_.explain(explained.literal, step).reasons, "; ");
    }
    response.literals.push_back(explained);
  }
}

}  // namespace kr3::reasoner
