#include "kr3_navigation/slip_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace kr3::navigation
{
namespace
{

constexpr double kMostTurned = 0.5;     // rad: a view that turned farther is not compared
constexpr std::size_t kThinning = 4;    // only so many hits are looked at in a search
constexpr double kStep = 0.05;          // m
constexpr double kTurnStep = 0.02;      // rad
constexpr double kTurnMargin = 0.04;    // rad, of odometry's own error
constexpr double kClearlyWrong = 0.25;  // share of the hits that disagree with odometry
constexpr double kPartShare = 0.6;      // of these, that a part of the way may have
constexpr int kLeastHits = 30;
constexpr int kLeastOutliers = 8;      // more against odometry than against the other motion
constexpr double kBetterShare = 0.35;  // of the outliers of odometry, that the other one may have

struct Agreement
{
  Pose motion;
  int hits = 0;
  int outliers = 0;

  [[nodiscard]] double share() const { return static_cast<double>(outliers) / std::max(1, hits); }
};

/// An earlier scan, as a table of ranges.
class View
{
public:
  View(const LaserScan& scan, const Pose& T_base_laser, double outlier_m)
    : scan_(scan), T_laser_base_(inverse(T_base_laser)), outlier_m_(outlier_m)
  {
  }

  /// How hits agree with it when the robot has moved since.
  /// @param hits  each `stride`-th is looked at, in the robot's present frame
  [[nodiscard]] Agreement agreement(const std::vector<Point>& hits, const Pose& motion,
                                    std::size_t stride) const
  {
    Agreement agreement{motion, 0, 0};
    const Pose T_laser_now = T_laser_base_ * motion;
    const double c = std::cos(T_laser_now.yaw);
    const double s = std::sin(T_laser_now.yaw);
    for (std::size_t hit = 0; hit < hits.size(); hit += stride)
    {
      const Point p{T_laser_now.x + c * hits[hit].x - s * hits[hit].y,
                    T_laser_now.y + s * hits[hit].x + c * hits[hit].y};
      const double away = distanceAt(std::atan2(p.y, p.x), std::hypot(p.x, p.y));
      if (!std::isfinite(away))
        continue;
      ++agreement.hits;
      agreement.outliers += away > outlier_m_ ? 1 : 0;
    }
    return agreement;
  }

private:
  /// How far a range is from that of the nearest beams; infinite without any.
  [[nodiscard]] double distanceAt(double angle_rad, double range_m) const
  {
    const auto num_beams = static_cast<long>(scan_.ranges_m.size());
    const double step = scan_.angle_increment_rad;
    // Counted from the first beam on, in the direction of the beams.
    double turned = std::fmod((angle_rad - scan_.angle_min_rad) * std::copysign(1.0, step), kTurn);
    if (turned < 0.0)
      turned += kTurn;
    const long nearest = std::lround(turned / std::abs(step));
    double least = std::numeric_limits<double>::infinity();
    for (long beam = nearest - 1; beam <= nearest + 1; ++beam)
    {
      const bool goes_round = std::abs(step) * static_cast<double>(num_beams) > kTurn - kWholeTurn;
      const long wrapped = goes_round ? (beam + num_beams) % num_beams : beam;
      if (wrapped < 0 || wrapped >= num_beams || !scan_.isHit(static_cast<std::size_t>(wrapped)))
        continue;
      const auto range = static_cast<double>(scan_.ranges_m[static_cast<std::size_t>(wrapped)]);
      least = std::min(least, std::abs(range - range_m));
    }
    return least;
  }

  static constexpr double kTurn = 2.0 * M_PI;
  static constexpr double kWholeTurn = 0.05;  // rad

  const LaserScan& scan_;
  Pose T_laser_base_;
  double outlier_m_;
};

/// The best of the motions on a lattice around `center`.
Agreement search(const View& view, const std::vector<Point>& hits, const Pose& center,
                 const Pose& reach, const Pose& step, std::size_t stride)
{
  Agreement best;
  best.hits = -1;
  const auto count = [](double half, double width) {
    return static_cast<int>(std::lround(half / width));
  };
  for (int i = -count(reach.x, step.x); i <= count(reach.x, step.x); ++i)
  {
    for (int j = -count(reach.y, step.y); j <= count(reach.y, step.y); ++j)
    {
      for (int k = -count(reach.yaw, step.yaw); k <= count(reach.yaw, step.yaw); ++k)
      {
        const Agreement here = view.agreement(
            hits, {center.x + i * step.x, center.y + j * step.y, center.yaw + k * step.yaw},
            stride);
        if (best.hits < 0 || here.share() < best.share())
          best = here;
      }
    }
  }
  return best;
}

/// Whether hits agree better with a part of the way, a cheap look before the search.
bool mayHaveSlipped(const View& view, const std::vector<Point>& hits, const Agreement& moved)
{
  for (const double share : {0.0, 0.25, 0.5, 0.75})
  {
    const Agreement part = search(
        view, hits, {share * moved.motion.x, share * moved.motion.y, moved.motion.yaw / 2.0},
        {0.0, 0.0, std::abs(moved.motion.yaw) / 2.0 + kTurnMargin}, {kStep, kStep, kTurnStep}, 1);
    if (part.share() < kPartShare * moved.share())
      return true;
  }
  return false;
}

}  // namespace

std::optional<Slip> SlipDetector::add(const LaserScan& scan, const Pose& T_base_laser,
                                      const Pose& T_odom_base)
{
  if (!earlier_)
  {
    earlier_ = Earlier{scan, T_base_laser, T_odom_base};
    return std::nullopt;
  }
  const Pose told = inverse(earlier_->T_odom_base) * T_odom_base;
  const bool turned = std::abs(told.yaw) > kMostTurned;
  if (!turned && distance(told.position(), {}) < options_.driven_m)
    return std::nullopt;
  const Earlier earlier = std::exchange(*earlier_, Earlier{scan, T_base_laser, T_odom_base});
  if (turned)
    return std::nullopt;
  const std::vector<Point> hits = hitPoints(scan, T_base_laser);
  const View view(earlier.scan, earlier.T_base_laser, options_.outlier_m);
  const Agreement moved =
      search(view, hits, told, {0.0, 0.0, kTurnMargin}, {kStep, kStep, kTurnStep / 2.0}, 1);
  const int least = std::max(
      kLeastOutliers, static_cast<int>(options_.least_share * static_cast<double>(moved.hits)));
  if (moved.hits < kLeastHits || moved.outliers < least)
    return std::nullopt;
  if (moved.share() < kClearlyWrong && !mayHaveSlipped(view, hits, moved))
    return std::nullopt;
  const Agreement coarse =
      search(view, hits, {}, {options_.farthest_m, options_.farthest_m, options_.farthest_rad},
             {kStep, kStep, kTurnStep}, kThinning);
  const Agreement other = search(view, hits, coarse.motion, {kStep, kStep, kTurnStep},
                                 {kStep / 2.0, kStep / 2.0, kTurnStep / 4.0}, 1);
  if (moved.outliers - other.outliers < least || other.share() > kBetterShare * moved.share())
    return std::nullopt;
  return Slip{told, other.motion};
}

}  // namespace kr3::navigation
