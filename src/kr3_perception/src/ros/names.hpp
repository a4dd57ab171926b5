#pragma once

namespace kr3::perception::names
{

inline constexpr char kImage[] = "camera/image_raw";
inline constexpr char kCameraInfo[] = "camera/camera_info";
inline constexpr char kDetections[] = "detections";
inline constexpr char kDetectionsImage[] = "detections/image";

}  // namespace kr3::perception::names
