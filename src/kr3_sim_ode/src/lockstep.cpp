#include "kr3_sim_ode/lockstep.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

Lockstep::Lockstep(std::uint64_t start_ns, std::uint64_t tick_ns,
                   const std::vector<std::string>& required)
  : start_ns_(start_ns), tick_ns_(tick_ns), required_(required)
{
  if (tick_ns == 0)
  {
    throw InvalidArgument("a tick must be longer than 0");
  }
  const std::set<std::string> different(required.begin(), required.end());
  if (different.size() != required.size() || different.count("") > 0)
  {
    throw InvalidArgument("the required consumers must have different names that are not empty");
  }
}

Lockstep::Schedule Lockstep::add(const std::string& name, std::uint64_t period_ns, double timeout_s,
                                 std::uint64_t now_ns, double wall_s)
{
  if (name.empty())
  {
    throw InvalidArgument("a consumer needs a name");
  }
  if (!(timeout_s > 0.0) || !std::isfinite(timeout_s))
  {
    throw InvalidArgument("timeout of " + std::to_string(timeout_s) + " s, expected above 0");
  }
  const std::uint64_t ticks = std::max<std::uint64_t>(1, (period_ns + tick_ns_ - 1) / tick_ns_);
  const std::uint64_t period = ticks * tick_ns_;
  const std::uint64_t first = start_ns_ + ((now_ns - start_ns_) / period + 1) * period;
  consumers_[name] = Consumer{period, timeout_s, first, wall_s};
  required_.erase(std::remove(required_.begin(), required_.end(), name), required_.end());
  return {first, period};
}

void Lockstep::remove(const std::string& name)
{
  (void)existing(name);
  consumers_.erase(name);
}

void Lockstep::acknowledge(const std::string& name, std::uint64_t stamp_ns,
                           std::uint32_t num_commands, std::uint64_t now_ns)
{
  Consumer& consumer = existing(name);
  if (stamp_ns > now_ns)
  {
    throw InvalidArgument("'" + name + "' acknowledged a stamp that is still to come");
  }
  consumer.acknowledged |= stamp_ns >= consumer.due_ns;
  consumer.commands_sent = std::max(consumer.commands_sent, num_commands);
}

void Lockstep::noteCommand(const std::string& node)
{
  const auto found = consumers_.find(node);
  if (found != consumers_.end())
  {
    ++found->second.commands_arrived;
  }
}

bool Lockstep::isReady(std::uint64_t now_ns) const
{
  return required_.empty() &&
         std::none_of(consumers_.begin(), consumers_.end(),
                      [&](const auto& entry) { return entry.second.blocks(now_ns); });
}

void Lockstep::advanced(std::uint64_t now_ns, double wall_s)
{
  for (auto& [name, consumer] : consumers_)
  {
    if (consumer.acknowledged && now_ns > consumer.due_ns)
    {
      const std::uint64_t passed = (now_ns - 1 - consumer.due_ns) / consumer.period_ns + 1;
      consumer.due_ns += passed * consumer.period_ns;
      consumer.acknowledged = false;
    }
    if (now_ns <= consumer.due_ns)
    {
      consumer.waiting_since_s = wall_s;
    }
  }
}

std::vector<std::string> Lockstep::expire(std::uint64_t now_ns, double wall_s)
{
  std::vector<std::string> expired;
  for (const auto& [name, consumer] : consumers_)
  {
    if (consumer.blocks(now_ns) && wall_s - consumer.waiting_since_s > consumer.timeout_s)
    {
      expired.push_back(name);
    }
  }
  for (const std::string& name : expired)
  {
    consumers_.erase(name);
  }
  return expired;
}

std::vector<std::string> Lockstep::consumers() const
{
  std::vector<std::string> names;
  for (const auto& [name, consumer] : consumers_)
  {
    names.push_back(name);
  }
  return names;
}

std::vector<std::string> Lockstep::waitingFor(std::uint64_t now_ns) const
{
  std::vector<std::string> names = required_;
  for (const auto& [name, consumer] : consumers_)
  {
    if (consumer.blocks(now_ns))
    {
      names.push_back(name);
    }
  }
  return names;
}

Lockstep::Consumer& Lockstep::existing(const std::string& name)
{
  const auto found = consumers_.find(name);
  if (found == consumers_.end())
  {
    throw NotFound("there is no consumer '" + name + "'");
  }
  return found->second;
}

}  // namespace kr3::sim
