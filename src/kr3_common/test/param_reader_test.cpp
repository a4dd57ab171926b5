#include "kr3_common/ros/param_reader.hpp"

#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>

#include "kr3_common/error.hpp"

namespace kr3
{
namespace
{

TEST(ParamReader, GivesTheSetValueOrTheDefault)
{
  ParamReader params(ros::NodeHandle("~"));
  EXPECT_DOUBLE_EQ(params.get("rate", 1.0), 10.0);
  EXPECT_EQ(params.get<std::string>("name", "x"), "base");
  EXPECT_EQ(params.get("not_set", 7), 7);
}

TEST(ParamReader, ReportsAllProblemsAtOnce)
{
  ParamReader params(ros::NodeHandle("~"));
  const double rate = params.get("rate", 1.0);
  params.check(rate < 5.0, "rate", "must be below 5");
  EXPECT_EQ(params.get("count", 3), 3);
  EXPECT_EQ(params.require<std::string>("map"), "");
  EXPECT_EQ(params.get<std::string>("name", ""), "base");
  try
  {
    params.finish();
    FAIL() << "finish() must throw";
  }
  catch (const InvalidArgument& e)
  {
    const std::string what = e.what();
    EXPECT_NE(what.find("~rate must be below 5"), std::string::npos) << what;
    EXPECT_NE(what.find("~count must be a whole number"), std::string::npos) << what;
    EXPECT_NE(what.find("~map is missing"), std::string::npos) << what;
    EXPECT_NE(what.find("~mispelt is unknown"), std::string::npos) << what;
    EXPECT_EQ(what.find("~name"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace kr3

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "param_reader_test");
  const ros::NodeHandle nh;  // keeps the node alive between tests
  return RUN_ALL_TESTS();
}
