#include "kr3_sim_ode/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace kr3::sim
{

Vector3 operator+(const Vector3& a, const Vector3& b)
{
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

Quaternion operator*(const Quaternion& a, const Quaternion& b)
{
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Vector3 rotated(const Quaternion& q, const Vector3& v)
{
  const Quaternion r = q * Quaternion{0.0, v.x, v.y, v.z} * Quaternion{q.w, -q.x, -q.y, -q.z};
  return {r.x, r.y, r.z};
}

Pose operator*(const Pose& T_a_b, const Pose& T_b_c)
{
  return {T_a_b.position + rotated(T_a_b.orientation, T_b_c.position),
          T_a_b.orientation * T_b_c.orientation};
}

Quaternion quaternionFromYawPitch(double yaw_rad, double pitch_rad)
{
  const Quaternion yaw{std::cos(yaw_rad / 2.0), 0.0, 0.0, std::sin(yaw_rad / 2.0)};
  const Quaternion pitch{std::cos(pitch_rad / 2.0), 0.0, std::sin(pitch_rad / 2.0), 0.0};
  return yaw * pitch;
}

double yawOf(const Quaternion& q)
{
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z));
}

Pose poseOf(const Pose2& pose, double z)
{
  return {{pose.x, pose.y, z}, quaternionFromYawPitch(pose.yaw, 0.0)};
}

double wrapped(double angle_rad)
{
  return std::atan2(std::sin(angle_rad), std::cos(angle_rad));
}

double planarDistance(const Box& box, double x, double y)
{
  const double dx = x - box.center.x;
  const double dy = y - box.center.y;
  const double local_x = std::cos(box.yaw) * dx + std::sin(box.yaw) * dy;
  const double local_y = -std::sin(box.yaw) * dx + std::cos(box.yaw) * dy;
  const double out_x = std::max(std::abs(local_x) - box.size.x / 2.0, 0.0);
  const double out_y = std::max(std::abs(local_y) - box.size.y / 2.0, 0.0);
  return std::hypot(out_x, out_y);
}

}  // namespace kr3::sim
