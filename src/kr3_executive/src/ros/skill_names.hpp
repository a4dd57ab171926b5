#pragma once

namespace kr3::executive::skills::names
{

inline constexpr char kSearch[] = "skills/search";
inline constexpr char kGrasp[] = "skills/grasp";
inline constexpr char kPutDown[] = "skills/put_down";
inline constexpr char kHandOver[] = "skills/hand_over";
inline constexpr char kHandOverRequest[] = "hand_over/request";
inline constexpr char kHandOverConfirm[] = "hand_over/confirm";
inline constexpr char kHandOverRefuse[] = "hand_over/refuse";
inline constexpr char kCells[] = "cells";
inline constexpr char kMap[] = "map";
inline constexpr char kScan[] = "scan";
inline constexpr char kOdometry[] = "odom";
inline constexpr char kDetections[] = "detections";
inline constexpr char kCameraInfo[] = "camera/camera_info";
inline constexpr char kCommand[] = "cmd_vel";
inline constexpr char kMoveBase[] = "move_base";
inline constexpr char kCloseGripper[] = "gripper/close";
inline constexpr char kOpenGripper[] = "gripper/open";
inline constexpr char kHolding[] = "gripper/holding";

}  // namespace kr3::executive::skills::names
