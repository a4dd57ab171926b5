#pragma once

/// Topics, services and frames of sim_node; all but /clock are relative and can be remapped.
namespace kr3::sim::names
{

constexpr char kClock[] = "/clock";
constexpr char kCommand[] = "cmd_vel";
constexpr char kOdometry[] = "odom";
constexpr char kScan[] = "scan";
constexpr char kImage[] = "camera/image_raw";
constexpr char kCameraInfo[] = "camera/camera_info";
constexpr char kCloseGripper[] = "gripper/close";
constexpr char kOpenGripper[] = "gripper/open";
constexpr char kHolding[] = "gripper/holding";
constexpr char kTruePose[] = "ground_truth/pose";
constexpr char kTrueModels[] = "ground_truth/models";
constexpr char kTrueTwists[] = "ground_truth/twists";
constexpr char kContacts[] = "ground_truth/contacts";
constexpr char kTrueOctomap[] = "ground_truth/octomap_binary";
constexpr char kState[] = "simulation/state";
constexpr char kDrop[] = "simulation/drop_held";
constexpr char kLockstepState[] = "lockstep/state";
constexpr char kAcknowledge[] = "lockstep/acknowledge";
constexpr char kRegister[] = "lockstep/register";
constexpr char kUnregister[] = "lockstep/unregister";
constexpr char kPause[] = "simulation/pause";
constexpr char kResume[] = "simulation/resume";
constexpr char kReset[] = "simulation/reset";
constexpr char kStep[] = "simulation/step";
constexpr char kSpawn[] = "simulation/spawn_model";
constexpr char kDelete[] = "simulation/delete_model";
constexpr char kSetPose[] = "simulation/set_model_pose";

constexpr char kWorldFrame[] = "world";
constexpr char kOdomFrame[] = "odom";
constexpr char kBaseFrame[] = "base_link";
constexpr char kLaserFrame[] = "laser";
constexpr char kCameraFrame[] = "camera_link";
constexpr char kOpticalFrame[] = "camera_optical_frame";
constexpr char kGripperFrame[] = "gripper";

}  // namespace kr3::sim::names
