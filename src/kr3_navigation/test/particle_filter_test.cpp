#include "kr3_navigation/particle_filter.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_navigation/movable_nodes.hpp"
#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

struct Drive
{
  double mean_error_m = 0.0;
  double max_error_m = 0.0;
  double last_yaw_error_rad = 0.0;
  Pose last;
};

/// Drives a circle in the left room with noisy odometry.
Drive driveCircle(std::uint64_t seed, const PoseSpread& spread, const Pose& initial_offset)
{
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  ParticleFilter filter(distanceField(world.grid(kTwoRoomsArea)), ParticleFilterOptions{}, seed);
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> normal;
  Pose truth{2.8, 2.2, 0.0};
  filter.reset(
      {truth.x + initial_offset.x, truth.y + initial_offset.y, truth.yaw + initial_offset.yaw},
      spread);
  Drive run;
  constexpr int kSteps = 200;
  constexpr int kSettle = 50;
  for (int i = 0; i < kSteps; ++i)
  {
    const Pose step{0.03, 0.0, 0.04};
    truth = truth * step;
    filter.predict(
        {step.x * (1.02 + 0.03 * normal(random)), 0.0, step.yaw * (0.97 + 0.03 * normal(random))});
    filter.update(world.scan(truth, random), Pose{});
    const double error = distance(filter.estimate().mean.position(), truth.position());
    if (i >= kSettle)
    {
      run.mean_error_m += error / (kSteps - kSettle);
      run.max_error_m = std::max(run.max_error_m, error);
    }
  }
  run.last_yaw_error_rad = std::abs(wrapAngle(filter.estimate().mean.yaw - truth.yaw));
  run.last = filter.estimate().mean;
  return run;
}

TEST(ParticleFilter, ConvergesWithinCentimetres)
{
  for (const std::uint64_t seed : {1, 2, 3})
  {
    const Drive run = driveCircle(seed, {0.3, 0.2}, {0.2, -0.15, 0.1});
    EXPECT_LT(run.mean_error_m, 0.05) << "seed " << seed;  // half a node: the map rounds its walls
    EXPECT_LT(run.max_error_m, 0.10) << "seed " << seed;
    EXPECT_LT(run.last_yaw_error_rad, 0.03) << "seed " << seed;
  }
}

TEST(ParticleFilter, RepeatsExactlyWithTheSameSeed)
{
  const Drive a = driveCircle(5, PoseSpread{}, {});
  const Drive b = driveCircle(5, PoseSpread{}, {});
  EXPECT_EQ(a.last.x, b.last.x);
  EXPECT_EQ(a.last.yaw, b.last.yaw);
}

TEST(ParticleFilter, KnowsHowProbableARoomIs)
{
  ParticleFilter filter(distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea)),
                        ParticleFilterOptions{}, 1);
  filter.reset({2.0, 2.0, 0.0}, {0.1, 0.05});
  EXPECT_NEAR(filter.probabilityIn({0.0, 0.0, 4.0, 4.0}), 1.0, 1e-9);
  EXPECT_NEAR(filter.probabilityIn({0.0, 0.0, 2.0, 4.0}), 0.5, 0.1);
  EXPECT_NEAR(filter.probabilityIn({4.0, 0.0, 8.0, 4.0}), 0.0, 1e-9);
}

TEST(ParticleFilter, CovarianceGrowsWithoutScans)
{
  ParticleFilter filter(distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea)),
                        ParticleFilterOptions{}, 1);
  filter.reset({1.0, 2.0, 0.0}, {0.01, 0.01});
  const double before = filter.estimate().covariance[0];
  for (int i = 0; i < 20; ++i)
    filter.predict({0.1, 0.0, 0.0});
  EXPECT_GT(filter.estimate().covariance[0], before);
  EXPECT_NEAR(filter.estimate().mean.x, 3.0, 0.05);
}

/// How far the pose is off, at worst over 60 scans, in front of a table that was moved since the
/// map was made.
double errorBesideMovedTable(const ParticleFilterOptions& options, bool turning, std::uint64_t seed)
{
  const SyntheticWorld mapped = SyntheticWorld::twoRooms();
  SyntheticWorld today = mapped;
  today.boxes.back() = {0.6, 0.75, 1.8, 1.35};
  const DistanceField field = distanceField(mapped.grid(kTwoRoomsArea));
  const std::vector<Place> rooms{{"left", {-0.05, -0.05, 4.0, 4.05}},
                                 {"right", {4.0, -0.05, 8.05, 4.05}}};
  ParticleFilter filter(field, options, seed, movableNodes(field, rooms));
  std::mt19937_64 random(seed);
  Pose truth{1.2, 1.7, 0.5};
  filter.reset(truth, {0.1, 0.05});
  double worst_m = 0.0;
  for (int scan = 0; scan < 60; ++scan)
  {
    const Pose step{0.0, 0.0, turning ? 0.1 : 0.0};
    truth = truth * step;
    filter.predict(step);
    filter.update(today.scan(truth, random), Pose{});
    worst_m = std::max(worst_m, distance(filter.estimate().mean.position(), truth.position()));
  }
  return worst_m;
}

TEST(ParticleFilter, IsNotPulledAlongByFurnitureThatWasMoved)
{
  ParticleFilterOptions naive;  // every beam of every scan counts alike
  naive.surface_m = 1e-6;
  naive.movable_weight = naive.view_at_rest = naive.likelihood_power = 1.0;
  double worst_m = 0.0;
  double worst_naive_m = 0.0;
  for (const std::uint64_t seed : {1, 2, 3, 4})
  {
    for (const bool turning : {false, true})
    {
      worst_m = std::max(worst_m, errorBesideMovedTable(ParticleFilterOptions{}, turning, seed));
      worst_naive_m = std::max(worst_naive_m, errorBesideMovedTable(naive, turning, seed));
    }
  }
  EXPECT_LT(worst_m, 0.06);
  EXPECT_GT(worst_naive_m, worst_m);
}

TEST(ParticleFilter, DoesNotGrowSureByLookingTwice)
{
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  const auto spreadAfter = [&](int scans) {
    ParticleFilter filter(distanceField(world.grid(kTwoRoomsArea)), ParticleFilterOptions{}, 1);
    std::mt19937_64 random(1);
    const Pose truth{2.8, 2.2, 0.0};
    filter.reset(truth, {0.1, 0.05});
    for (int scan = 0; scan < scans; ++scan)
      filter.update(world.scan(truth, random), Pose{});
    return std::sqrt(filter.estimate().covariance[0]);
  };
  // Ten independent scans would divide the deviation by 3.
  EXPECT_GT(spreadAfter(11), spreadAfter(1) / 2.0);
}

TEST(ParticleFilter, RefusesWhatDoesNotFitTheMap)
{
  const DistanceField field = distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea));
  EXPECT_THROW(ParticleFilter(field, ParticleFilterOptions{}, 1, std::vector<char>(3)),
               InvalidArgument);
  ParticleFilterOptions options;
  options.surface_m = 0.0;
  EXPECT_THROW(ParticleFilter(field, options, 1), InvalidArgument);
}

TEST(ParticleFilter, RefusesNoParticles)
{
  ParticleFilterOptions options;
  options.num_particles = 0;
  EXPECT_THROW(ParticleFilter(DistanceField{}, options, 1), InvalidArgument);
}

}  // namespace
}  // namespace kr3::navigation
