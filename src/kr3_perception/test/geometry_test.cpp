#include "kr3_perception/geometry.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

const Intrinsics kCamera{500.0, 500.0, 320.0, 240.0, {640, 480}};
const ObjectDescription kObject{"box", "thing", 0.4, 0.2};

/// The box under which the camera sees a flat object of kObject's size at `p`.
cv::Rect seenAt(const cv::Point3d& p)
{
  const double width = kCamera.fx * kObject.width_m / p.z;
  const double height = kCamera.fy * kObject.height_m / p.z;
  return {cvRound(kCamera.fx * p.x / p.z + kCamera.cx - width / 2),
          cvRound(kCamera.fy * p.y / p.z + kCamera.cy - height / 2), cvRound(width),
          cvRound(height)};
}

TEST(PositionFromBox, InvertsTheProjection)
{
  for (const cv::Point3d& p :
       {cv::Point3d(0.0, 0.0, 2.0), cv::Point3d(-0.5, 0.3, 1.5), cv::Point3d(0.8, -0.2, 2.5)})
  {
    const auto found = positionFromBox(seenAt(p), kObject, kCamera);
    ASSERT_TRUE(found);
    EXPECT_LT(cv::norm(*found - p), 0.05 * p.z);
  }
}

TEST(PositionFromBox, UsesTheWidthWhereTheHeightIsCutOff)
{
  const cv::Rect whole = seenAt({0.0, -0.95, 2.0});
  const cv::Rect seen = whole & cv::Rect(0, 0, 640, 480);
  ASSERT_LT(seen.height, whole.height);
  const auto found = positionFromBox(seen, kObject, kCamera);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->z, 2.0, 0.1);
}

TEST(PositionFromBox, HasNoAnswerForACornerOfTheImage)
{
  EXPECT_FALSE(positionFromBox({0, 0, 50, 50}, kObject, kCamera));
  EXPECT_FALSE(positionFromBox({10, 10, 0, 0}, kObject, kCamera));
}

TEST(PositionFromBox, RejectsACameraWithoutFocalLength)
{
  EXPECT_THROW((void)positionFromBox({10, 10, 20, 20}, kObject, Intrinsics{}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
