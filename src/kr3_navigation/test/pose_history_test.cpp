#include "kr3_navigation/pose_history.hpp"

#include <gtest/gtest.h>

namespace kr3::navigation
{
namespace
{

TEST(PoseHistory, InterpolatesAlsoAcrossHalfATurn)
{
  PoseHistory history(2.0);
  EXPECT_FALSE(history.at(0.0));
  history.add(1.0, {0.0, 0.0, 3.0});
  history.add(2.0, {1.0, 2.0, -3.0});
  const Pose middle = *history.at(1.5);
  EXPECT_NEAR(middle.x, 0.5, 1e-9);
  EXPECT_NEAR(middle.y, 1.0, 1e-9);
  EXPECT_NEAR(std::abs(middle.yaw), M_PI, 1e-9);
  EXPECT_TRUE(history.covers(2.0));
  EXPECT_FALSE(history.covers(2.1));
  EXPECT_FALSE(history.at(0.9));
  EXPECT_FALSE(history.at(2.1));
}

TEST(PoseHistory, ForgetsWhatIsOldAndIgnoresWhatIsLate)
{
  PoseHistory history(1.0);
  history.add(1.0, {1.0, 0.0, 0.0});
  history.add(3.0, {3.0, 0.0, 0.0});
  history.add(2.0, {9.0, 0.0, 0.0});
  EXPECT_FALSE(history.at(1.0));
  EXPECT_EQ(history.latest().x, 3.0);
}

TEST(Geometry, InverseAndCompositionAreLaws)
{
  const Pose T{1.0, -2.0, 0.7};
  const Pose identity = T * inverse(T);
  EXPECT_NEAR(identity.x, 0.0, 1e-12);
  EXPECT_NEAR(identity.y, 0.0, 1e-12);
  EXPECT_NEAR(identity.yaw, 0.0, 1e-12);
  const Point p = (T * Pose{0.3, 0.4, 0.0}) * Point{1.0, 1.0};
  const Point q = T * Point{1.3, 1.4};
  EXPECT_NEAR(p.x, q.x, 1e-12);
  EXPECT_NEAR(p.y, q.y, 1e-12);
}

}  // namespace
}  // namespace kr3::navigation
