#pragma once

namespace kr3::sim
{

/// A point or direction; metres unless said otherwise.
struct Vector3
{
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

/// A unit quaternion.
struct Quaternion
{
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

/// T_a_b: the pose of frame b in frame a.
struct Pose
{
  Vector3 position;
  Quaternion orientation;
};

/// A pose on the floor: metres, radians.
struct Pose2
{
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
};

/// An axis-aligned rectangle on the floor, metres; x0 < x1 and y0 < y1.
struct Rectangle
{
  double x0 = 0.0;
  double y0 = 0.0;
  double x1 = 0.0;
  double y1 = 0.0;

  [[nodiscard]] bool contains(double x, double y) const
  {
    return x0 <= x && x <= x1 && y0 <= y && y <= y1;
  }
};

/// A solid box: centre in the world, full size, turned by `yaw` about z.
struct Box
{
  Vector3 center;
  Vector3 size;
  double yaw = 0.0;
};

[[nodiscard]] Vector3 operator+(const Vector3& a, const Vector3& b);
[[nodiscard]] Quaternion operator*(const Quaternion& a, const Quaternion& b);
[[nodiscard]] Vector3 rotated(const Quaternion& q, const Vector3& v);

/// T_a_c = T_a_b * T_b_c.
[[nodiscard]] Pose operator*(const Pose& T_a_b, const Pose& T_b_c);

[[nodiscard]] Quaternion quaternionFromYawPitch(double yaw_rad, double pitch_rad);
[[nodiscard]] double yawOf(const Quaternion& q);
[[nodiscard]] Pose poseOf(const Pose2& pose, double z);

/// The angle in (-pi, pi].
[[nodiscard]] double wrapped(double angle_rad);

/// The smallest distance on the floor from (x, y) to the box's footprint; 0 inside.
[[nodiscard]] double planarDistance(const Box& box, double x, double y);

}  // namespace kr3::sim
