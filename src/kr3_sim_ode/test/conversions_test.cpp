#include "conversions.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "names.hpp"

namespace kr3::sim
{

TEST(Conversions, PosesComeBack)
{
  const Pose pose{{1.0, -2.0, 3.0}, {0.5, -0.5, 0.5, -0.5}};
  const Pose back = fromMsg(toMsg(pose));
  EXPECT_EQ(back.position.y, -2.0);
  EXPECT_EQ(back.orientation.x, -0.5);
  EXPECT_EQ(back.orientation.z, -0.5);
}

TEST(Conversions, TheOpticalFrameLooksAlongZ)
{
  for (const auto& msg : mountTransforms(ros::Time(1.0), RobotModel{}))
  {
    if (msg.child_frame_id == names::kOpticalFrame)
    {
      const auto& r = msg.transform.rotation;
      const Vector3 forward = rotated({r.w, r.x, r.y, r.z}, {0.0, 0.0, 1.0});
      const Vector3 right = rotated({r.w, r.x, r.y, r.z}, {1.0, 0.0, 0.0});
      EXPECT_NEAR(forward.x, 1.0, 1e-12);
      EXPECT_NEAR(right.y, -1.0, 1e-12);
      return;
    }
  }
  FAIL() << "no optical frame";
}

TEST(Conversions, TheCameraLooksDown)
{
  const Vector3 forward = rotated(RobotModel{}.T_base_camera().orientation, {1.0, 0.0, 0.0});
  EXPECT_LT(forward.z, -0.1);
}

TEST(Conversions, CameraInfoHasTheFieldOfView)
{
  const CameraModel camera{640, 480, 1.22};
  const auto info = toCameraInfo(ros::Time(1.0), camera);
  EXPECT_NEAR(2.0 * std::atan(320.0 / info.K[0]), 1.22, 1e-12);
  EXPECT_EQ(info.K[2], 319.5);
  EXPECT_EQ(info.K[5], 239.5);
  EXPECT_EQ(info.P[0], info.K[0]);
}

TEST(Conversions, ScansKeepBeamsAnglesAndInfinity)
{
  LaserModel laser;
  laser.num_beams = 4;
  const double infinity = std::numeric_limits<double>::infinity();
  const auto scan = toScan(ros::Time(1.0), laser, 0.1, {1.0, 2.0, infinity, 4.0});
  ASSERT_EQ(scan.ranges.size(), 4U);
  EXPECT_TRUE(std::isinf(scan.ranges[2]));
  EXPECT_NEAR(scan.angle_min + 2.0F * scan.angle_increment, 0.0F, 1e-6F) << "beam 2 looks ahead";
  EXPECT_NEAR(scan.angle_max, scan.angle_min + 3.0F * scan.angle_increment, 1e-6F);
}

TEST(Conversions, ImagesKeepTheirPixels)
{
  cv::Mat image(2, 3, CV_8UC3, cv::Scalar(1, 2, 3));
  image.at<cv::Vec3b>(1, 2) = {7, 8, 9};
  const auto msg = toImage(ros::Time(1.0), image);
  EXPECT_EQ(msg.width, 3U);
  EXPECT_EQ(msg.height, 2U);
  ASSERT_EQ(msg.data.size(), 18U);
  EXPECT_EQ(msg.data[0], 1);
  EXPECT_EQ(msg.data[17], 9);
}

}  // namespace kr3::sim
