#include "kr3_perception/evaluation.hpp"

#include <gtest/gtest.h>

#include "kr3_perception/reliability_diagram.hpp"

namespace kr3::perception
{
namespace
{

const std::map<std::string, std::string> kClassOf{{"a", "x"}, {"b", "y"}};

TEST(Overlap, IsOneForEqualZeroForDisjointAndSymmetric)
{
  const cv::Rect box(10, 10, 20, 20);
  EXPECT_DOUBLE_EQ(overlap(box, box), 1.0);
  EXPECT_DOUBLE_EQ(overlap(box, {100, 100, 5, 5}), 0.0);
  EXPECT_DOUBLE_EQ(overlap(box, {10, 20, 20, 20}), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(overlap({10, 20, 20, 20}, box), 1.0 / 3.0);
}

TEST(Evaluation, CountsRightWrongAndMissed)
{
  Evaluation evaluation(0.5, 100, 0.4);
  const std::vector<Label> labels{{"a", 1, {10, 10, 20, 20}, 400}, {"b", 2, {60, 60, 20, 20}, 400}};
  evaluation.add({{"a", "x", 0.9, {11, 10, 20, 20}}, {"b", "y", 0.8, {120, 10, 20, 20}}}, labels,
                 kClassOf);
  EXPECT_EQ(evaluation.classes().at("x").right, 1);
  EXPECT_EQ(evaluation.classes().at("y").wrong, 1);
  EXPECT_EQ(evaluation.classes().at("y").missed, 1);
  EXPECT_EQ(evaluation.objects().at("a").right, 1);
  EXPECT_EQ(evaluation.objects().at("b").wrong, 1);
  EXPECT_EQ(evaluation.objects().at("b").missed, 1);
  EXPECT_DOUBLE_EQ(evaluation.total().precision(), 0.5);
  EXPECT_DOUBLE_EQ(evaluation.total().recall(), 0.5);
  EXPECT_NEAR(evaluation.brier(), (0.1 * 0.1 + 0.8 * 0.8) / 2.0, 1e-12);
}

TEST(Evaluation, CountsEachOfSeveralEqualObjectsOnce)
{
  Evaluation evaluation(0.5, 100, 0.4);
  const std::vector<Label> labels{{"a", 1, {10, 10, 20, 20}, 400}, {"a", 2, {60, 60, 20, 20}, 400}};
  evaluation.add({{"a", "x", 0.9, {10, 10, 20, 20}}, {"a", "x", 0.8, {60, 60, 20, 20}}}, labels,
                 kClassOf);
  EXPECT_EQ(evaluation.total().right, 2);
  // The same place told twice is wrong once, and the other object is missed.
  evaluation.add({{"a", "x", 0.9, {10, 10, 20, 20}}, {"a", "x", 0.8, {10, 11, 20, 20}}}, labels,
                 kClassOf);
  EXPECT_EQ(evaluation.total().right, 3);
  EXPECT_EQ(evaluation.total().wrong, 1);
  EXPECT_EQ(evaluation.total().missed, 1);
}

TEST(WilsonInterval, HasKnownValuesAndHoldsTheShare)
{
  // Agresti and Coull (1998): 10 of 10 gives [0.722, 1]; by symmetry 0 of 10 gives [0, 0.278].
  EXPECT_NEAR(wilsonInterval(10, 10).low, 0.722, 1e-3);
  EXPECT_NEAR(wilsonInterval(0, 10).high, 0.278, 1e-3);
  EXPECT_EQ(wilsonInterval(0, 0).low, 0.0);
  EXPECT_EQ(wilsonInterval(0, 0).high, 1.0);
}

TEST(ReliabilityDiagram, DrawsEvenWithoutDetections)
{
  Evaluation evaluation(0.5, 100, 0.4);
  const cv::Mat empty = reliabilityDiagram(evaluation, "empty");
  evaluation.add({{"a", "x", 0.95, {10, 10, 20, 20}}}, {{"a", 1, {10, 10, 20, 20}, 400}}, kClassOf);
  const cv::Mat one = reliabilityDiagram(evaluation, "empty");
  ASSERT_EQ(empty.size(), one.size());
  EXPECT_GT(cv::norm(empty, one), 0.0);
}

TEST(Evaluation, IgnoresObjectsTooSmallToCount)
{
  Evaluation evaluation(0.5, 100, 0.4);
  evaluation.add({}, {{"a", 1, {10, 10, 5, 5}, 25}}, kClassOf);
  EXPECT_EQ(evaluation.total().missed, 0);
}

TEST(Evaluation, IgnoresDetectionsBelowTheThresholdExceptForCalibration)
{
  Evaluation evaluation(0.5, 100, 0.4);
  evaluation.add({{"a", "x", 0.2, {0, 0, 5, 5}}}, {}, kClassOf);
  EXPECT_EQ(evaluation.total().wrong, 0);
  EXPECT_EQ(evaluation.reliability()[2].detections, 1);
  EXPECT_NEAR(evaluation.brier(), 0.04, 1e-12);
}

}  // namespace
}  // namespace kr3::perception
