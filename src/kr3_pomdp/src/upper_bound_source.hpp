#pragma once

#include <cstddef>
#include <cstdint>

namespace kr3::pomdp
{

/// Upper bounds of values from elsewhere than the belief graph's own points, worked out piece by
/// piece while the search goes on.
class UpperBoundSource
{
public:
  UpperBoundSource() = default;
  UpperBoundSource(const UpperBoundSource&) = delete;
  UpperBoundSource& operator=(const UpperBoundSource&) = delete;
  virtual ~UpperBoundSource() = default;

  /// Does a piece of work, that of some backups; the same pieces in every run.
  virtual void advance() = 0;
  /// Whether there is nothing left to work out.
  [[nodiscard]] virtual bool finished() const = 0;

  /// Grows when the bounds got enough better to ask for them again; 0 = there are none yet.
  [[nodiscard]] virtual std::uint32_t version() const = 0;
  /// No policy earns more from the belief on.
  /// @param belief  shape [states of the class]
  /// @pre version() is not 0
  virtual double upper(std::uint32_t state_class, const double* belief) = 0;

  /// Memory held, roughly.
  [[nodiscard]] virtual std::size_t sizeInBytes() const = 0;
};

}  // namespace kr3::pomdp
