#include "kr3_pomdp/policy_bundle.hpp"

#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdp_format.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

std::shared_ptr<const NamedModel> tiger()
{
  std::ostringstream text;
  writePomdp(text, test::tiger());
  return std::make_shared<const NamedModel>(NamedModel{{"pomdp", text.str()}, test::tiger()});
}

std::string bundleOf(const SolvedModel& solved)
{
  std::ostringstream out;
  writeBundle(out, solved);
  return out.str();
}

SolvedModel read(const std::string& text, std::size_t max_bytes = 0)
{
  std::istringstream in(text);
  return readBundle(in, "b", max_bytes);
}

std::string errorOf(const std::string& text)
{
  try
  {
    (void)read(text);
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "no error";
}

SolvedModel solvedTiger()
{
  SolverLimits limits;
  limits.precision = 0.1;
  limits.time_s = 20.0;
  limits.max_memory_bytes = std::size_t{1} << 33U;
  const auto source = tiger();
  return solvedModel(source, limits, solve(source->model, limits));
}

TEST(PolicyBundle, GivesBackTheSame)
{
  const SolvedModel solved = solvedTiger();
  const std::string text = bundleOf(solved);
  const SolvedModel again = read(text);
  EXPECT_EQ(again.source->text, solved.source->text);
  EXPECT_EQ(again.lower, solved.lower);
  EXPECT_EQ(again.upper, solved.upper);
  EXPECT_EQ(again.backups, solved.backups);
  EXPECT_EQ(again.reason, solved.reason);
  EXPECT_TRUE(sameLimits(again.limits, solved.limits));
  EXPECT_EQ(bundleOf(again), text);
  EXPECT_EQ(contentHash(again), contentHash(solved));
  EXPECT_TRUE(answers(again, solved.limits));  // a node may start with it
}

TEST(PolicyBundle, AModelWithoutAPolicyToo)
{
  const SolvedModel model = unsolvedModel(tiger(), std::nullopt);
  const SolvedModel again = read(bundleOf(model));
  EXPECT_FALSE(again.policy);
  EXPECT_FALSE(again.reason);
  EXPECT_EQ(again.lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(again.upper, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(answers(again, model.limits));
}

TEST(PolicyBundle, WhatIsDamagedIsRefused)
{
  const std::string text = bundleOf(solvedTiger());
  std::string changed = text;
  changed[changed.find("listen")] = 'g';
  const std::string end = text.substr(text.find("limits"));
  EXPECT_EQ(errorOf(changed), "b: the bundle was cut short or changed since it was written");
  EXPECT_EQ(errorOf(text.substr(0, text.size() / 2)),
            "b: the bundle was cut short or changed since it was written");
  EXPECT_EQ(errorOf("policy\n"), "b: found 'policy', expected 'kr3_policy_bundle 1'");
  EXPECT_EQ(errorOf(""), "b: the bundle of a policy ends too early");
  EXPECT_THROW((void)read(text, 100), ResourceExhausted);
  // With the right hash, the parts are checked one by one.
  const auto rehashed = [&end](const std::string& from, const std::string& to) {
    std::string body = end;
    body.replace(body.find(from), from.size(), to);
    return "kr3_policy_bundle 1\nhash " + contentHash(body) + "\n" + body;
  };
  EXPECT_EQ(errorOf(rehashed("bounds ", "bounds x")).substr(0, 11), "b: found 'x");
  EXPECT_EQ(errorOf(rehashed("reason precision", "reason whim")),
            "b: found the reason 'whim', expected one of the solver's");
  EXPECT_EQ(errorOf(rehashed("format pomdp", "format text")),
            "b: found the format 'text', expected 'pomdp' or 'pomdpx'");
  EXPECT_NE(errorOf(rehashed("discount: ", "discount; ")).find("b (model):1:1:"),
            std::string::npos);
  EXPECT_NE(errorOf(rehashed("model ", "model 99")).find("cut short"), std::string::npos);
  EXPECT_NE(errorOf(rehashed("\nstates 2\n", "\nstates 3\n")).find("b (policy)"),
            std::string::npos);
}

TEST(PolicyBundle, APolicyThatDoesNotFitIsRefused)
{
  const Policy policy(2, {{0, {}, {-7.0, -7.0}}});
  std::string body = bundleOf(unsolvedModel(tiger(), policy));
  body.erase(0, body.find("limits"));
  body.replace(body.find("0 0 -7 -7"), 1, "9");
  EXPECT_EQ(errorOf("kr3_policy_bundle 1\nhash " + contentHash(body) + "\n" + body),
            "b: a policy over 2 states with actions up to 9, the model has 2 states and 3 actions");
}

}  // namespace
}  // namespace kr3::pomdp
