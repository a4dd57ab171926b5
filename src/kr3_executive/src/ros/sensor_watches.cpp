#include "sensor_watches.hpp"

namespace kr3::executive
{

SensorWatches::SensorWatches(ros::NodeHandle nh, const std::vector<Watch>& watches)
  : watches_(watches), sensors_(watches.size())
{
  for (std::size_t i = 0; i < watches_.size(); ++i)
  {
    const auto take = [this, i](const std_msgs::Bool& message) {
      const std::lock_guard<std::mutex> lock(mutex_);
      Sensor& sensor = sensors_[i];
      const bool value = message.data != 0;
      // The first message after the start tells a state, not a change.
      sensor.turned = sensor.turned || (sensor.known && value != sensor.value);
      sensor.known = true;
      sensor.value = value;
    };
    subscribers_.push_back(nh.subscribe<std_msgs::Bool>(
        watches_[i].topic, 10, [take](const std_msgs::BoolConstPtr& m) { take(*m); }));
  }
}

void SensorWatches::begin()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& sensor : sensors_)
    sensor.turned = false;
}

std::vector<Sighting> SensorWatches::sightings(const FluentLookup& believed) const
{
  std::vector<Sighting> noticed;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < watches_.size(); ++i)
  {
    const Watch& watch = watches_[i];
    if (!sensors_[i].turned || sensors_[i].value != watch.becomes)
      continue;
    const char* contrary = watch.holds ? "false" : "true";
    for (const auto& fluent : watch.fluents)
    {
      if (believed(fluent) == contrary)
        noticed.push_back({watch.holds ? fluent : "-" + fluent, watch.confidence});
    }
  }
  return noticed;
}

}  // namespace kr3::executive
