#pragma once

/// Every topic, service and action of navigation_node, once. All relative except ROS's own.
namespace kr3::navigation::names
{

constexpr const char* kCells = "cells";
constexpr const char* kCellMarkers = "cell_markers";
constexpr const char* kCmdVel = "cmd_vel";
constexpr const char* kGroundTruthPose = "ground_truth/pose";
constexpr const char* kInitialPose = "initialpose";
constexpr const char* kMap = "map";
constexpr const char* kMoveBase = "move_base";
constexpr const char* kMoveTo = "skills/move_to";
constexpr const char* kOctomapBinary = "octomap_binary";
constexpr const char* kOdom = "odom";
constexpr const char* kPath = "path";
constexpr const char* kPose = "pose";
constexpr const char* kSaveMap = "save_map";
constexpr const char* kScan = "scan";
constexpr const char* kTf = "/tf";
constexpr const char* kTfStatic = "/tf_static";

}  // namespace kr3::navigation::names
