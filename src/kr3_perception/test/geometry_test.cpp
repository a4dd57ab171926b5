#include "kr3_perception/geometry.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

const Intrinsics kCamera{500.0, 500.0, 320.0, 240.0, {640, 480}, false, {}};
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

/// Where a camera with Brown's distortion sees a point of the normalised image plane.
/// Source: OpenCV's calib3d reference, "Detailed description".
cv::Point2d distorted(const cv::Point2d& p, const std::vector<double>& d)
{
  const double r2 = p.dot(p);
  const double radial = 1.0 + d[0] * r2 + d[1] * r2 * r2;
  const double x = p.x * radial + 2 * d[2] * p.x * p.y + d[3] * (r2 + 2 * p.x * p.x);
  const double y = p.y * radial + d[2] * (r2 + 2 * p.y * p.y) + 2 * d[3] * p.x * p.y;
  return {kCamera.fx * x + kCamera.cx, kCamera.fy * y + kCamera.cy};
}

TEST(NormalisedRay, InvertsTheLens)
{
  Intrinsics camera = kCamera;
  camera.distortion = {-0.25, 0.05, 0.002, -0.001};
  for (const cv::Point2d& p :
       {cv::Point2d(0.0, 0.0), cv::Point2d(0.4, -0.3), cv::Point2d(-0.5, 0.2)})
    EXPECT_LT(cv::norm(normalisedRay(distorted(p, camera.distortion), camera) - p), 1e-6);
}

TEST(PositionFromBox, TakesTheLensIntoAccount)
{
  Intrinsics camera = kCamera;
  camera.distortion = {-0.30, 0.08, 0.0, 0.0};
  const cv::Point3d p(0.9, 0.35, 2.0);
  const auto seen = [&](double dx, double dy) {
    return distorted({(p.x + dx) / p.z, (p.y + dy) / p.z}, camera.distortion);
  };
  const cv::Rect box(cv::Point(cvRound(seen(-0.2, 0.0).x), cvRound(seen(0.0, -0.1).y)),
                     cv::Point(cvRound(seen(0.2, 0.0).x), cvRound(seen(0.0, 0.1).y)));
  const auto with = positionFromBox(box, kObject, camera);
  const auto without = positionFromBox(box, kObject, kCamera);
  ASSERT_TRUE(with && without);
  EXPECT_LT(cv::norm(*with - p), 0.1);
  EXPECT_GT(cv::norm(*without - p), 2.0 * cv::norm(*with - p));
}

TEST(PositionFromBox, HasNoAnswerForAnUnknownSize)
{
  EXPECT_FALSE(positionFromBox({100, 100, 50, 50}, {"photo", "thing", 0.0, 0.0}, kCamera));
}

TEST(NormalisedRay, RejectsANumberOfCoefficientsThatNoModelHas)
{
  Intrinsics camera = kCamera;
  camera.distortion = {0.1, 0.1, 0.1};
  EXPECT_THROW((void)normalisedRay({1.0, 1.0}, camera), InvalidArgument);
  camera.fisheye = true;
  camera.distortion.assign(5, 0.0);
  EXPECT_THROW((void)normalisedRay({1.0, 1.0}, camera), InvalidArgument);
}

TEST(PositionFromBox, RejectsACameraWithoutFocalLength)
{
  EXPECT_THROW((void)positionFromBox({10, 10, 20, 20}, kObject, Intrinsics{}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
