#include "conversions.hpp"

#include <cmath>

#include <sensor_msgs/image_encodings.h>

#include "names.hpp"

namespace kr3::sim
{

namespace
{
template <typename Msg>
Msg vectorMsg(const Vector3& v)
{
  Msg msg;
  msg.x = v.x;
  msg.y = v.y;
  msg.z = v.z;
  return msg;
}
}  // namespace

geometry_msgs::Pose toMsg(const Pose& pose)
{
  geometry_msgs::Pose msg;
  msg.position.x = pose.position.x;
  msg.position.y = pose.position.y;
  msg.position.z = pose.position.z;
  msg.orientation.w = pose.orientation.w;
  msg.orientation.x = pose.orientation.x;
  msg.orientation.y = pose.orientation.y;
  msg.orientation.z = pose.orientation.z;
  return msg;
}

Pose fromMsg(const geometry_msgs::Pose& pose)
{
  return {{pose.position.x, pose.position.y, pose.position.z},
          {pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z}};
}

std_msgs::Header makeHeader(const ros::Time& stamp, const std::string& frame)
{
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = frame;
  return header;
}

geometry_msgs::TransformStamped toTransform(const ros::Time& stamp, const std::string& parent,
                                            const std::string& child, const Pose& T_parent_child)
{
  geometry_msgs::TransformStamped msg;
  msg.header = makeHeader(stamp, parent);
  msg.child_frame_id = child;
  const geometry_msgs::Pose pose = toMsg(T_parent_child);
  msg.transform.translation.x = pose.position.x;
  msg.transform.translation.y = pose.position.y;
  msg.transform.translation.z = pose.position.z;
  msg.transform.rotation = pose.orientation;
  return msg;
}

nav_msgs::Odometry toOdometry(const ros::Time& stamp, const std::string& frame, const Pose& pose,
                              const Velocity& velocity)
{
  nav_msgs::Odometry msg;
  msg.header = makeHeader(stamp, frame);
  msg.child_frame_id = names::kBaseFrame;
  msg.pose.pose = toMsg(pose);
  msg.twist.twist.linear.x = velocity.speed_m_s;
  msg.twist.twist.angular.z = velocity.turn_rate_rad_s;
  return msg;
}

sensor_msgs::LaserScan toScan(const ros::Time& stamp, const LaserModel& laser, double period_s,
                              const std::vector<double>& ranges)
{
  sensor_msgs::LaserScan msg;
  msg.header = makeHeader(stamp, names::kLaserFrame);
  const double increment = 2.0 * M_PI / laser.num_beams;
  msg.angle_min = static_cast<float>(-M_PI);
  msg.angle_increment = static_cast<float>(increment);
  msg.angle_max = static_cast<float>(-M_PI + increment * (laser.num_beams - 1));
  msg.scan_time = static_cast<float>(period_s);
  msg.range_min = static_cast<float>(laser.min_range_m);
  msg.range_max = static_cast<float>(laser.max_range_m);
  msg.ranges.assign(ranges.begin(), ranges.end());
  return msg;
}

sensor_msgs::Image toImage(const ros::Time& stamp, const cv::Mat& image)
{
  sensor_msgs::Image msg;
  msg.header = makeHeader(stamp, names::kOpticalFrame);
  msg.height = static_cast<std::uint32_t>(image.rows);
  msg.width = static_cast<std::uint32_t>(image.cols);
  msg.encoding = sensor_msgs::image_encodings::BGR8;
  msg.step = msg.width * 3;
  msg.data.assign(image.datastart, image.dataend);
  return msg;
}

sensor_msgs::CameraInfo toCameraInfo(const ros::Time& stamp, const CameraModel& camera)
{
  sensor_msgs::CameraInfo msg;
  msg.header = makeHeader(stamp, names::kOpticalFrame);
  msg.height = static_cast<std::uint32_t>(camera.height);
  msg.width = static_cast<std::uint32_t>(camera.width);
  msg.distortion_model = "plumb_bob";
  msg.D.assign(camera.distortion.begin(), camera.distortion.end());
  const double f = camera.focalLengthPixels();
  const double u = (camera.width - 1) / 2.0;  // pixel centres have whole coordinates
  const double v = (camera.height - 1) / 2.0;
  msg.K = {f, 0.0, u, 0.0, f, v, 0.0, 0.0, 1.0};
  msg.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  msg.P = {f, 0.0, u, 0.0, 0.0, f, v, 0.0, 0.0, 0.0, 1.0, 0.0};
  return msg;
}

kr3_msgs::ModelStates toModelStates(const ros::Time& stamp, const World& world)
{
  kr3_msgs::ModelStates msg;
  msg.header = makeHeader(stamp, names::kWorldFrame);
  for (const ObjectState& object : world.objects())
  {
    kr3_msgs::ModelPose model;
    model.name = object.name;
    model.pose = toMsg(object.pose);
    msg.models.push_back(model);
  }
  msg.held = world.held().value_or("");
  return msg;
}

kr3_msgs::ModelTwists toModelTwists(const ros::Time& stamp, const std::vector<BodyTwist>& twists)
{
  kr3_msgs::ModelTwists msg;
  msg.header = makeHeader(stamp, names::kWorldFrame);
  for (const BodyTwist& twist : twists)
  {
    msg.names.push_back(twist.name);
    geometry_msgs::Twist& out = msg.twists.emplace_back();
    out.linear = vectorMsg<geometry_msgs::Vector3>(twist.linear_m_s);
    out.angular = vectorMsg<geometry_msgs::Vector3>(twist.angular_rad_s);
  }
  return msg;
}

kr3_msgs::ContactArray toContactArray(const ros::Time& stamp,
                                      const std::vector<ContactReport>& contacts)
{
  kr3_msgs::ContactArray msg;
  msg.header = makeHeader(stamp, names::kWorldFrame);
  for (const ContactReport& contact : contacts)
  {
    kr3_msgs::Contact& out = msg.contacts.emplace_back();
    out.body_a = contact.body_a;
    out.body_b = contact.body_b;
    out.position = vectorMsg<geometry_msgs::Point>(contact.position);
    out.normal = vectorMsg<geometry_msgs::Vector3>(contact.normal);
    out.depth = contact.depth_m;
    out.impulse = contact.impulse_ns;
  }
  return msg;
}

std::vector<geometry_msgs::TransformStamped> mountTransforms(const ros::Time& stamp,
                                                             const RobotModel& robot)
{
  const Pose T_camera_optical{{}, {0.5, -0.5, 0.5, -0.5}};  // x right, y down, z forward
  return {
      toTransform(stamp, names::kBaseFrame, names::kLaserFrame, robot.T_base_laser),
      toTransform(stamp, names::kBaseFrame, names::kCameraFrame, robot.T_base_camera()),
      toTransform(stamp, names::kCameraFrame, names::kOpticalFrame, T_camera_optical),
      toTransform(stamp, names::kBaseFrame, names::kGripperFrame, robot.T_base_gripper),
  };
}

}  // namespace kr3::sim
