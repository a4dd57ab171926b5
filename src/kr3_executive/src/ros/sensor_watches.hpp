#pragma once

#include <mutex>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include "kr3_executive/bindings.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// The sensors that the bindings watch: what they tell during a low-level action becomes sightings.
///
/// Messages may arrive on other threads. The watches must outlive it.
class SensorWatches
{
public:
  SensorWatches(ros::NodeHandle nh, const std::vector<Watch>& watches);
  SensorWatches(const SensorWatches&) = delete;
  SensorWatches& operator=(const SensorWatches&) = delete;

  /// An action begins: what was told before is none of its business.
  void begin();

  /// What changed since begin(): the fluents of each sensor that turned to its value and kept it,
  /// as far as the robot believes the contrary of what the sensor tells.
  [[nodiscard]] std::vector<Sighting> sightings(const FluentLookup& believed) const;

private:
  struct Sensor
  {
    bool known = false;   ///< a message has come
    bool value = false;   ///< the last one
    bool turned = false;  ///< since begin()
  };

  const std::vector<Watch>& watches_;
  mutable std::mutex mutex_;
  std::vector<Sensor> sensors_;  // shape [watches_]
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace kr3::executive
