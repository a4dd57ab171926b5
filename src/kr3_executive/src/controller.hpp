#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kr3_executive/domain_belief.hpp"

namespace kr3::executive
{

/// Chooses low-level actions from what is believed about the whole domain.
class Controller
{
public:
  Controller() = default;
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;
  virtual ~Controller() = default;

  /// @return an action of the belief's task; nothing when giving up is worth more than going on
  [[nodiscard]] virtual std::optional<std::size_t> next(const DomainBelief& belief,
                                                        const std::atomic<bool>& cancel) = 0;

  /// What came of the action that next() gave.
  virtual void observed(const std::vector<std::string>& /*observation*/) {}
  /// The belief changed in another way: somebody told something, or it had to be corrected.
  virtual void disturbed() {}

  /// High-level actions begun, and the present one.
  [[nodiscard]] virtual std::uint32_t numHighLevelActions() const { return 0; }
  [[nodiscard]] virtual std::string highLevelAction() const { return {}; }
  /// What was planned with, for people.
  [[nodiscard]] virtual std::string description() const = 0;
};

using ControllerFactory = std::function<std::unique_ptr<Controller>(
    const DomainBelief& start, const reasoner::Formula& goal, const std::atomic<bool>& cancel)>;

}  // namespace kr3::executive
