#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "kr3_navigation/laser_scan.hpp"
#include "kr3_navigation/occupancy_grid.hpp"

namespace kr3::navigation
{

struct ParticleFilterOptions
{
  int num_particles = 400;
  int beam_step = 8;          ///< every eighth beam is used, each time a different eighth
  double hit_sigma_m = 0.06;  ///< of the distance between a hit and the nearest obstacle of the map
  double random_hit =
      0.2;  ///< likelihood floor relative to a perfect hit: what the map does not know
  double likelihood_power = 0.6;  ///< in (0, 1]: beams are not independent
  /// A hit that stands for less surface than this weighs less, in proportion: what is near is hit
  /// by many beams, and would outvote a wall when it was moved.
  double surface_m = 0.4;
  /// Of what may be moved, relative to walls, [0, 1]: see movableNodes().
  double movable_weight = 0.3;
  // A scan shows something new as far as the robot has moved since the last one: errors of the map
  // are the same in every scan from one place, and do not average out. A full scan's worth comes
  // with so much driving or turning, and a share of it with every scan that is taken at rest.
  double new_view_m = 0.2;
  double new_view_rad = 0.5;
  double view_at_rest = 0.1;
  // Noise of odometry: share of the distance driven and of the angle turned, and a floor per
  // update.
  double drive_noise = 0.08;
  double turn_noise = 0.08;
  double drive_floor_m = 0.001;
  double turn_floor_rad = 0.002;
};

/// Standard deviations of a pose, m and rad.
struct PoseSpread
{
  double position_m = 0.1;
  double yaw_rad = 0.05;
};

struct PoseEstimate
{
  Pose mean;                           ///< map frame
  std::array<double, 9> covariance{};  ///< x, y, yaw; row-major, shape [3, 3]
  double mean_hit_distance_m =
      0.0;  ///< of the last scan's hits from the map at the mean pose: how well they fit
};

/// Monte Carlo localisation with a likelihood field. The same seed and inputs give the same poses.
/// Not thread-safe.
/// Source: Thrun, Burgard and Fox, "Probabilistic Robotics" (2005), Table 6.3 (likelihood field),
/// Table 8.2 (MCL). Tempering by `likelihood_power`, by surface, by motion and by what may be moved
/// is ours: it keeps furniture that was moved a little from pulling the pose along.
class ParticleFilter
{
public:
  /// @param field    distances to the map's obstacles
  /// @param movable  per node of the field, whether the nearest obstacle may have been moved; empty
  ///                 when nothing is known about that
  /// @throws InvalidArgument  an option is out of range, or `movable` has another shape
  ParticleFilter(DistanceField field, const ParticleFilterOptions& options, std::uint64_t seed,
                 const std::vector<char>& movable = {});

  /// Starts again around a pose.
  void reset(const Pose& mean, const PoseSpread& spread);

  /// Localises in another map from now on, keeping the particles.
  /// @param movable  see ParticleFilter()
  /// @throws InvalidArgument  `movable` has another shape than the field
  void setField(DistanceField field, const std::vector<char>& movable = {});

  /// Moves every particle by the odometry since the last call.
  /// @param T_before_now  the robot's pose now in its frame before
  void predict(const Pose& T_before_now);

  /// Weighs every particle by a scan, and resamples when few carry the weight.
  /// Cost: about 0.25 ms for 400 particles and 45 beams.
  void update(const LaserScan& scan, const Pose& T_base_laser);

  [[nodiscard]] const PoseEstimate& estimate() const { return estimate_; }
  /// Probability that the robot is inside a rectangle, by the particles' weights.
  [[nodiscard]] double probabilityIn(const Rectangle& area) const;

private:
  struct Particle
  {
    Pose pose;
    double weight;
  };

  /// A hit in the robot's frame.
  struct WeightedHit
  {
    Point p_base;
    double weight;
  };
  [[nodiscard]] std::vector<WeightedHit> takeHits(const LaserScan& scan, const Pose& T_base_laser);

  /// Log-likelihood of a hit at a point, from the table; of an unmapped one off the grid.
  [[nodiscard]] double logLikelihood(Point p) const;
  void summarise();
  void resample();

  DistanceField field_;
  std::vector<float> log_likelihood_;  ///< of a hit in each node, shape [height, width]
  ParticleFilterOptions options_;
  std::mt19937_64 random_;
  std::vector<Particle> particles_;
  int first_beam_ = 0;
  double new_view_ = 1.0;  ///< what the next scan can show that is new, in full scans
  PoseEstimate estimate_;
};

}  // namespace kr3::navigation
