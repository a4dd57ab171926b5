#include "detector_node.hpp"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/param_reader.hpp>
#include <kr3_msgs/DetectionArray.h>

#include "conversions.hpp"
#include "kr3_perception/drawing.hpp"
#include "kr3_perception/model_file.hpp"
#include "names.hpp"

namespace kr3::perception
{
namespace
{

constexpr double kDiagnosticsPeriod_s = 1.0;
constexpr double kMaxRate_Hz = 1000.0;

}  // namespace

DetectorNodeConfig loadDetectorNodeConfig(const ros::NodeHandle& private_nh)
{
  DetectorNodeConfig config;
  ParamReader params(private_nh);
  config.model = params.require<std::string>("model");
  config.detector.min_probability = params.get("min_probability", config.detector.min_probability);
  config.detector.max_features = params.get("max_features", config.detector.max_features);
  config.detector.search_checks = params.get("search_checks", config.detector.search_checks);
  config.detector.max_instances = params.get("max_instances", config.detector.max_instances);
  params.check(config.detector.min_probability >= 0.0 && config.detector.min_probability < 1.0,
               "min_probability", "must be in [0, 1)");
  params.check(config.detector.max_features > 0, "max_features", "must be > 0");
  params.check(config.detector.search_checks > 0, "search_checks", "must be > 0");
  params.check(config.detector.max_instances >= 0, "max_instances", "must be >= 0");
  config.max_rate = params.get("max_rate", config.max_rate);
  params.check(config.max_rate >= 0.0 && config.max_rate <= kMaxRate_Hz, "max_rate",
               "must be in [0, 1000]");
  config.lockstep = params.get("lockstep", config.lockstep);
  params.finish();
  return config;
}

DetectorNode::DetectorNode(const ros::NodeHandle& nh, const DetectorNodeConfig& config)
  : nh_(nh)
  , detector_(loadModel(config.model), config.detector)
  , period_ns_(config.max_rate > 0.0 ? static_cast<std::uint64_t>(1e9 / config.max_rate) : 0)
{
  diagnostics_.setHardwareID("none");
  diagnostics_.add("detector", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    diagnose(status);
  });
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) {
    onListenersChanged();
  };
  detections_ = nh_.advertise<kr3_msgs::DetectionArray>(names::kDetections, 1, changed, changed);
  picture_ = nh_.advertise<sensor_msgs::Image>(names::kDetectionsImage, 1, changed, changed);
  diagnostics_timer_ =
      nh_.createWallTimer(ros::WallDuration(kDiagnosticsPeriod_s),
                          [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  if (config.lockstep)
    lockstep_ = std::make_unique<LockstepConsumer>(nh_);
  ROS_INFO("detector ready: %zu objects from %s", detector_.model().objects.size(),
           config.model.c_str());
}

void DetectorNode::onListenersChanged()
{
  const bool wanted = detections_.getNumSubscribers() + picture_.getNumSubscribers() > 0;
  if (wanted && !images_)
  {
    // A queue of one: an image that comes while another is processed replaces the one that waits.
    camera_infos_ = nh_.subscribe(names::kCameraInfo, 1, &DetectorNode::onCameraInfo, this);
    images_ = nh_.subscribe(names::kImage, 1, &DetectorNode::onImage, this,
                            ros::TransportHints().tcpNoDelay());
  }
  else if (!wanted && images_)
  {
    images_.shutdown();
    camera_infos_.shutdown();
    waiting_.reset();
  }
}

void DetectorNode::onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info)
{
  try
  {
    camera_ = fromMsg(*info);
  }
  catch (const InvalidArgument& e)
  {
    camera_.reset();
    ROS_WARN_THROTTLE(5.0, "unusable calibration on %s: %s", camera_infos_.getTopic().c_str(),
                      e.what());
  }
  if (!waiting_)
    return;
  const sensor_msgs::ImageConstPtr image = waiting_;
  waiting_.reset();
  process(*image);
}

/// Whether an image is the first of its period. Periods are counted from time 0, so that the rate
/// does not drift and the images of a camera whose own rate is a multiple are always the same ones.
bool DetectorNode::isDue(const ros::Time& stamp)
{
  if (period_ns_ == 0)
    return true;
  const std::uint64_t slot = stamp.toNSec() / period_ns_;
  if (last_slot_ == slot)
    return false;
  last_slot_ = slot;
  return true;
}

void DetectorNode::onImage(const sensor_msgs::ImageConstPtr& image)
{
  if (!isDue(image->header.stamp))
    return;
  // The calibration travels on a topic of its own and may be a little later than the first image.
  if (!camera_ && !waiting_ && num_images_ == 0)
  {
    waiting_ = image;
    return;
  }
  if (waiting_)
  {
    ROS_WARN("no calibration on %s: detections have no positions",
             camera_infos_.getTopic().c_str());
    const sensor_msgs::ImageConstPtr first = waiting_;
    waiting_.reset();
    process(*first);
  }
  process(*image);
}

void DetectorNode::process(const sensor_msgs::Image& image)
{
  const ros::WallTime start = ros::WallTime::now();
  ++num_images_;
  kr3_msgs::DetectionArray message;
  message.header = image.header;
  try
  {
    checkSize(image);
    const cv_bridge::CvImagePtr bgr =
        cv_bridge::toCvCopy(image, sensor_msgs::image_encodings::BGR8);
    const std::vector<Detection> detections = detector_.detect(bgr->image);
    for (const Detection& detection : detections)
    {
      std::optional<cv::Point3d> position;
      for (const ObjectDescription& object : detector_.model().objects)
        if (camera_ && object.name == detection.name)
          position = positionFromBox(detection.box, object, *camera_);
      message.detections.push_back(toMsg(detection, position));
    }
    if (picture_.getNumSubscribers() > 0)
    {
      draw(bgr->image, detections);
      picture_.publish(bgr->toImageMsg());
    }
  }
  catch (const cv_bridge::Exception& e)
  {
    return reportBadImage(e.what());
  }
  catch (const cv::Exception& e)
  {
    return reportBadImage(e.what());
  }
  catch (const Error& e)
  {
    return reportBadImage(e.what());
  }
  detections_.publish(message);
  num_detections_ += message.detections.size();
  last_problem_.clear();
  last_duration_ms_ = (ros::WallTime::now() - start).toSec() * 1e3;
}

void DetectorNode::reportBadImage(const std::string& why)
{
  ++num_bad_images_;
  last_problem_ = why;
  ROS_WARN_THROTTLE(5.0, "unusable image: %s", why.c_str());
}

void DetectorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const
{
  using diagnostic_msgs::DiagnosticStatus;
  if (!last_problem_.empty())
    status.summary(DiagnosticStatus::ERROR, "unusable image: " + last_problem_);
  else if (!images_)
    status.summary(DiagnosticStatus::OK, "nobody listens");
  else if (num_images_ > 0 && !camera_)
    status.summary(DiagnosticStatus::WARN, "camera is not calibrated: no positions");
  else
    status.summary(DiagnosticStatus::OK, "detecting");
  status.add("objects", detector_.model().objects.size());
  status.add("images", num_images_);
  status.add("unusable images", num_bad_images_);
  status.add("detections", num_detections_);
  status.add("last image (ms)", last_duration_ms_);
}

}  // namespace kr3::perception
