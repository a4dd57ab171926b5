#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner::tool
{

/// Keys keep the order in which they are written.
using Json = nlohmann::ordered_json;

/// What was asked on the command line.
struct Arguments
{
  std::string command;
  std::vector<std::string> files;
  std::vector<std::string> histories;
  std::vector<std::string> assumed;  ///< records of what-if questions
  int progress = -1;  ///< the step to which the history is progressed; below 0: it is not
  std::string base;
  std::string goal;
  std::string literal;
  std::string format = "text";
  int step = -1;  ///< the current one
  int length = -1;
  int max_horizon = 12;
  double time_limit_s = 0.0;  ///< of each question; 0: none, and a minute for a plan
  std::string preference = "shortest";
  int max_plans = 100;
  bool whole = false;  ///< plan on the whole description
  std::size_t limit = 10;
  bool all = false;
  std::string part = "description";  ///< of an imported program, in text
  bool exit_code = false;
  bool exogenous = false;
  int exception_weight = 1;
  int exogenous_weight = 1;
  std::vector<std::string> default_weights;  ///< NAME=WEIGHT
};

/// An answer for machines, and whether it is what the question hopes for (a plan, an entailment, a
/// consistent history).
struct Reply
{
  Json json;
  bool positive = true;
};

/// What each command answers. The README has the fields.
/// @throws Error  the description, the history or the question is wrong
[[nodiscard]] Reply check(const Arguments& arguments);
[[nodiscard]] Reply translate(const Arguments& arguments);
[[nodiscard]] Reply entails(const Arguments& arguments);
[[nodiscard]] Reply explain(const Arguments& arguments);
[[nodiscard]] Reply models(const Arguments& arguments);
[[nodiscard]] Reply diagnose(const Arguments& arguments);
[[nodiscard]] Reply plan(const Arguments& arguments);
[[nodiscard]] Reply relevant(const Arguments& arguments);
[[nodiscard]] Reply importSparc(const Arguments& arguments);

}  // namespace kr3::reasoner::tool
