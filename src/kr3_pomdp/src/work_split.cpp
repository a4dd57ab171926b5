#include "work_split.hpp"

#include <algorithm>

namespace kr3::pomdp
{

namespace
{

constexpr double kTrialsFirst = 2e7;    // work before the grid begins: easy models need none
constexpr double kLeastShare = 0.04;    // of the grid
constexpr double kFirstShare = 0.2;     // until its rate is known
constexpr double kGreatestShare = 0.6;  // trials alone find better policies
constexpr double kForget = 0.5;

}  // namespace

void WorkSplit::Side::add(std::uint64_t more_work, double gain)
{
  work += static_cast<double>(more_work);
  recent_work += static_cast<double>(more_work);
  recent_gain += gain;
}

void WorkSplit::Side::close()
{
  if (recent_work > 0.0)
  {
    const double recent_rate = recent_gain / recent_work;
    rate = rated ? kForget * rate + (1.0 - kForget) * recent_rate : recent_rate;
    rated = true;
    recent_work = 0.0;
    recent_gain = 0.0;
  }
}

bool WorkSplit::gridIsDue() const
{
  if (exhausted_ || trials_.work < kTrialsFirst)
  {
    return false;
  }
  double share = kFirstShare;
  if (grid_.rated && grid_.rate + trials_.rate > 0.0)
  {
    share = std::clamp(grid_.rate / (grid_.rate + trials_.rate), kLeastShare, kGreatestShare);
  }
  return grid_.work < share * (grid_.work + trials_.work);
}

void WorkSplit::addRound(std::uint64_t work, double gain, bool changed)
{
  grid_.add(work, gain);
  grid_.close();
  trials_.close();
  exhausted_ = !changed;
}

}  // namespace kr3::pomdp
