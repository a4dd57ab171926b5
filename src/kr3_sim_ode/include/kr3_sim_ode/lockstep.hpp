#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kr3::sim
{

/// Who must acknowledge which stamp before simulated time goes on.
///
/// Time advances by ticks. A consumer with period P is waited for at the multiples of P after the
/// start of time, the grid on which sensors of that period publish, from the first one after its
/// registration: there the simulation stands until the consumer acknowledged that stamp or a later
/// one and all velocity commands that it says it sent have arrived. Stamps are nanoseconds of
/// simulated time, wall times are seconds of any steady clock. Not thread-safe.
class Lockstep
{
public:
  /// When a consumer is waited for.
  struct Schedule
  {
    std::uint64_t first_ns;
    std::uint64_t period_ns;
  };

  /// @param start_ns  the first stamp
  /// @param tick_ns   simulated time between two stamps
  /// @param required  consumers without whom time does not begin to run
  /// @throws InvalidArgument  `tick_ns` is 0, or a name is empty or there twice
  Lockstep(std::uint64_t start_ns, std::uint64_t tick_ns, const std::vector<std::string>& required);

  /// Registers a consumer; one of the same name that is registered already starts anew.
  /// @param period_ns  0: every tick; else rounded up to ticks
  /// @return the first stamp to acknowledge, after `now_ns`, and the period in use
  /// @throws InvalidArgument  an empty name, or a timeout that is not above 0
  Schedule add(const std::string& name, std::uint64_t period_ns, double timeout_s,
               std::uint64_t now_ns, double wall_s);

  /// @throws NotFound  no such consumer
  void remove(const std::string& name);

  /// @param num_commands  velocity commands that the consumer sent since it registered
  /// @throws NotFound         no such consumer
  /// @throws InvalidArgument  a stamp that lies in the future
  void acknowledge(const std::string& name, std::uint64_t stamp_ns, std::uint32_t num_commands,
                   std::uint64_t now_ns);

  /// A velocity command of the node of this name has arrived; other nodes are ignored.
  void noteCommand(const std::string& node);

  /// Whether time may advance by a tick from `now_ns`.
  [[nodiscard]] bool isReady(std::uint64_t now_ns) const;

  /// Time was advanced to `now_ns`: consumers that are due there are waited for from now on.
  void advanced(std::uint64_t now_ns, double wall_s);

  /// Removes the consumers that were waited for longer than their timeout, unless `now_ns` is not
  /// due for them. A removed consumer is not required any more either.
  /// @return their names
  std::vector<std::string> expire(std::uint64_t now_ns, double wall_s);

  [[nodiscard]] std::vector<std::string> consumers() const;

  /// Those whom the simulation waits for at `now_ns`, registered or required.
  [[nodiscard]] std::vector<std::string> waitingFor(std::uint64_t now_ns) const;

private:
  struct Consumer
  {
    std::uint64_t period_ns;
    double timeout_s;
    std::uint64_t due_ns;  ///< the stamp to acknowledge next
    double waiting_since_s;
    std::uint32_t commands_sent = 0;
    std::uint32_t commands_arrived = 0;
    bool acknowledged = false;  ///< due_ns is

    [[nodiscard]] bool blocks(std::uint64_t now_ns) const
    {
      return now_ns >= due_ns && (!acknowledged || commands_arrived < commands_sent);
    }
  };

  Consumer& existing(const std::string& name);

  std::uint64_t start_ns_;
  std::uint64_t tick_ns_;
  std::vector<std::string> required_;  // not registered yet
  std::map<std::string, Consumer> consumers_;
};

}  // namespace kr3::sim
