#pragma once

#include <map>
#include <string>

#include <geometry_msgs/Point.h>
#include <visualization_msgs/MarkerArray.h>

#include <kr3_msgs/BeliefState.h>
#include <kr3_msgs/CellArray.h>
#include <kr3_msgs/MissionState.h>

namespace kr3::executive
{

/// Belief and plan as markers in the frame of the map's cells. Each array begins with DELETEALL, so
/// that it replaces the one before.
class MissionMarkers
{
public:
  explicit MissionMarkers(const kr3_msgs::CellArray& cells);

  /// For each fluent whose values are cells a box on each of them, the more opaque the more
  /// probable (at least 0.01), and a text with the probability.
  [[nodiscard]] visualization_msgs::MarkerArray of(const kr3_msgs::BeliefState& belief) const;

  /// What is left of the plan: a text on each place that an action names, and a line between the
  /// places. Actions that name no place stand where the one before them does.
  [[nodiscard]] visualization_msgs::MarkerArray of(const kr3_msgs::MissionState& mission) const;

private:
  struct Area
  {
    geometry_msgs::Point center;  ///< m
    double size_x = 0.0;          ///< m
    double size_y = 0.0;          ///< m
  };

  std_msgs::Header header_;
  std::map<std::string, Area> cells_;
  std::map<std::string, geometry_msgs::Point> places_;  // mean of the centres of their cells
};

}  // namespace kr3::executive
