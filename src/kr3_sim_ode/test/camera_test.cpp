#include "kr3_sim_ode/camera.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/robot.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

class Camera : public testing::Test
{
protected:
  Building building = loadBuilding(kData + "two_rooms.yaml");
  std::vector<ObjectModel> models = loadObjectModels(kData + "objects.yaml");
  CameraModel camera{320, 240, 1.22};
  Renderer renderer{building, models, camera};
  Pose T_world_camera = poseOf(Pose2{2.0, 2.0, -M_PI / 2.0}, 0.0) * RobotModel{}.T_base_camera();
};
}  // namespace

TEST_F(Camera, ShowsAnObjectWhereProjectionSays)
{
  const Vector3 point{2.3, 0.45, 0.54};
  const cv::Mat mask = renderer.mask(
      T_world_camera, {{"cup", "cup", {{6.0, 1.0, 0.06}, {}}}, {"book", "book", {point, {}}}});
  ASSERT_EQ(mask.type(), CV_8UC1);
  cv::Mat seen;
  cv::findNonZero(mask == 2, seen);
  ASSERT_GT(seen.total(), 50U);
  EXPECT_EQ(cv::countNonZero(mask == 1), 0) << "the cup is in the other room";

  // The pinhole model, by hand: the camera stands at (2, 1.85, 0.65), looks along -y and down by
  // its pitch.
  const double pitch = RobotModel{}.camera_pitch_rad;
  const double forward = 1.85 - point.y;
  const double up = point.z - 0.65;
  const double depth = forward * std::cos(pitch) - up * std::sin(pitch);
  const double down = -(forward * std::sin(pitch) + up * std::cos(pitch));
  const double left = point.x - 2.0;  // facing -y, +x is to the left
  const double f = camera.focalLengthPixels();
  const cv::Scalar center = cv::mean(seen);
  EXPECT_NEAR(center[0], 159.5 - f * left / depth, 3.0);
  EXPECT_NEAR(center[1], 119.5 + f * down / depth, 4.0);
}

TEST_F(Camera, BendsThePictureAsKAndDSay)
{
  camera.distortion = {-0.25, 0.06, 0.002, -0.001, 0.0};
  ObjectModel dot = models.front();
  dot.name = "dot";
  dot.shape = Shape::kBox;
  dot.size = {0.03, 0.03, 0.03};
  Renderer bending(building, {dot}, camera);
  const double f = camera.focalLengthPixels();
  const cv::Matx33d K(f, 0, (camera.width - 1) / 2.0, 0, f, (camera.height - 1) / 2.0, 0, 0, 1);
  const std::vector<double> D(camera.distortion.begin(), camera.distortion.end());
  double greatest_shift = 0.0;
  for (const double right : {-0.62, -0.3, 0.0, 0.35, 0.6})
  {
    for (const double down : {-0.45, 0.0, 0.42})
    {
      const double depth = 1.0;
      // Camera link: x forward, y left, z up; optical: x right, y down, z forward.
      const Pose T_camera_dot{{depth, -right * depth, -down * depth}, {}};
      const cv::Mat mask =
          bending.mask(T_world_camera, {{"dot", "dot", T_world_camera * T_camera_dot}});
      cv::Mat seen;
      cv::findNonZero(mask, seen);
      ASSERT_GT(seen.total(), 6U) << right << " " << down;
      std::vector<cv::Point2d> bent;
      const std::vector<cv::Point3d> points{{right * depth, down * depth, depth}};
      cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, D, bent);
      const cv::Scalar center = cv::mean(seen);
      EXPECT_NEAR(center[0], bent[0].x, 0.8) << right << " " << down;
      EXPECT_NEAR(center[1], bent[0].y, 0.8) << right << " " << down;
      greatest_shift = std::max(greatest_shift, std::hypot(bent[0].x - K(0, 2) - f * right,
                                                           bent[0].y - K(1, 2) - f * down));
    }
  }
  EXPECT_GT(greatest_shift, 15.0) << "the test must be able to fail";
}

TEST_F(Camera, RefusesALensThatFoldsThePicture)
{
  camera.distortion = {-3.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_THROW(Renderer(building, models, camera), InvalidArgument);
  camera.distortion = {std::nan(""), 0.0, 0.0, 0.0, 0.0};
  EXPECT_THROW(Renderer(building, models, camera), InvalidArgument);
}

TEST_F(Camera, IsRepeatableAndNotBlack)
{
  const std::vector<ObjectState> objects{{"book", "book", {{2.0, 0.45, 0.54}, {}}}};
  const cv::Mat first = renderer.image(T_world_camera, objects);
  (void)renderer.mask(T_world_camera, objects);  // must leave no trace
  const cv::Mat second = renderer.image(T_world_camera, objects);
  ASSERT_EQ(first.type(), CV_8UC3);
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0.0);
  const cv::Scalar mean = cv::mean(first);
  EXPECT_GT(mean[1], 80.0);
  EXPECT_LT(mean[1], 250.0);
}

TEST_F(Camera, ShowsTheCoverToWhomItFaces)
{
  // The book's front looks along its +x; seen from there, its texture is not mirrored: left of the
  // picture is left of the texture, which is -y of the book.
  const Pose facing = poseOf(Pose2{2.0, 0.9, M_PI / 2.0}, 0.54);
  const cv::Mat image = renderer.image(T_world_camera, {{"book", "book", facing}});
  const cv::Mat mask = renderer.mask(T_world_camera, {{"book", "book", facing}});
  const cv::Mat texture = cv::imread(kData + "checks.png");
  ASSERT_FALSE(texture.empty());
  const cv::Rect box = cv::boundingRect(mask);
  cv::Mat expected;
  cv::resize(texture, expected, box.size(), 0, 0, cv::INTER_AREA);
  cv::Mat mirrored;
  cv::flip(expected, mirrored, 1);
  cv::Mat upside_down;
  cv::flip(expected, upside_down, 0);
  const double right_way = cv::norm(image(box), expected, cv::NORM_L1);
  EXPECT_LT(right_way, 0.7 * cv::norm(image(box), mirrored, cv::NORM_L1));
  EXPECT_LT(right_way, 0.7 * cv::norm(image(box), upside_down, cv::NORM_L1));
}

TEST_F(Camera, DoesNotSeeWhatTheRobotCarries)
{
  const Pose T_world_base = poseOf(Pose2{2.0, 2.0, -M_PI / 2.0}, 0.0);
  const Pose carried = T_world_base * Pose{RobotModel{}.carry_position, {}};
  EXPECT_EQ(cv::countNonZero(renderer.mask(T_world_camera, {{"crate", "crate", carried}})), 0);
}

TEST_F(Camera, LightChangesWithTheSeed)
{
  renderer.setLight(1);
  const cv::Mat first = renderer.image(T_world_camera, {});
  renderer.setLight(2);
  const cv::Mat other = renderer.image(T_world_camera, {});
  renderer.setLight(1);
  const cv::Mat again = renderer.image(T_world_camera, {});
  EXPECT_GT(cv::norm(first, other, cv::NORM_INF), 3.0);
  EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0.0);
}

TEST(ImageNoiseTest, HasTheStatedSpread)
{
  const CameraModel camera{320, 240, 1.22};
  ImageNoise noise(camera, {0.0, 4.0}, 1);
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar::all(128));
  noise.apply(image);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(image, mean, deviation);
  EXPECT_NEAR(mean[0], 128.0, 0.5);
  EXPECT_NEAR(deviation[0], 4.0, 0.3);
}

}  // namespace kr3::sim
