#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <kr3_common/ros/lockstep_consumer.hpp>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/geometry.hpp"

namespace kr3::perception
{

struct DetectorNodeConfig
{
  std::string model;  ///< path of the model file
  DetectorOptions detector;
  double max_rate = 0.0;  ///< images a second, by their stamps; 0: every one
  bool lockstep = false;  ///< a simulation waits while an image is processed
};

/// @throws InvalidArgument  listing every bad parameter
[[nodiscard]] DetectorNodeConfig loadDetectorNodeConfig(const ros::NodeHandle& private_nh);

/// Detects objects in camera images while somebody listens. Single-threaded: spin it on one thread.
class DetectorNode
{
public:
  DetectorNode(const ros::NodeHandle& nh, const DetectorNodeConfig& config);

private:
  void onListenersChanged();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info);
  [[nodiscard]] bool isDue(const ros::Time& stamp);
  void process(const sensor_msgs::Image& image);
  void reportBadImage(const std::string& why);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  ros::NodeHandle nh_;
  Detector detector_;
  std::uint64_t period_ns_;                 ///< of images that are looked at; 0: every one
  std::optional<std::uint64_t> last_slot_;  ///< the period that the last such image fell in
  std::optional<Intrinsics> camera_;
  sensor_msgs::ImageConstPtr waiting_;  ///< the first image, until the camera's calibration arrives

  std::uint64_t num_images_ = 0;
  std::uint64_t num_bad_images_ = 0;
  std::uint64_t num_detections_ = 0;
  std::string last_problem_;
  double last_duration_ms_ = 0.0;

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher detections_;
  ros::Publisher picture_;
  ros::Subscriber images_;
  ros::Subscriber camera_infos_;
  ros::WallTimer diagnostics_timer_;
  std::unique_ptr<LockstepConsumer> lockstep_;
};

}  // namespace kr3::perception
