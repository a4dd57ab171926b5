#include "kr3_navigation/map_comparison.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

OccupancyMap mapped(const SyntheticWorld& world, double resolution_m, double noise_m)
{
  OccupancyMapOptions options;
  options.resolution_m = resolution_m;
  OccupancyMap map(options);
  std::mt19937_64 random(1);
  for (int pass = 0; pass < 2; ++pass)
  {
    for (double x = 0.5; x < 7.5; x += 0.1)
    {
      const Pose pose{x, 2.0, 0.3 * x};
      map.insertScan(world.scan(pose, random, noise_m), pose, 0.35, 8.0);
    }
  }
  return map;
}

TEST(MapComparison, AMapAgreesWithItself)
{
  const OccupancyMap map = mapped(SyntheticWorld::twoRooms(), 0.1, 0.01);
  const MapAgreement same = compareMaps(map, map, {});
  EXPECT_EQ(same.occupiedPrecision(), 1.0);
  EXPECT_EQ(same.occupiedRecall(), 1.0);
  EXPECT_EQ(same.freePrecision(), 1.0);
  EXPECT_EQ(same.freeRecall(), 1.0);
  EXPECT_GT(same.occupied_right, 100);
}

TEST(MapComparison, CountsWhatWasTakenAwayAndWhatIsNew)
{
  SyntheticWorld world = SyntheticWorld::twoRooms();
  const OccupancyMap truth = mapped(world, 0.1, 0.0);
  world.boxes.back() = {5.6, 2.8, 6.8, 3.4};  // the table went to the other room
  const MapAgreement moved = compareMaps(mapped(world, 0.1, 0.0), truth, {});
  EXPECT_GT(moved.occupied_wrong, 20);
  EXPECT_GT(moved.occupied_missed, 10);
  EXPECT_LT(moved.occupiedPrecision(), 0.97);
  EXPECT_LT(moved.occupiedRecall(), 0.97);
}

TEST(MapComparison, TakesTheCoarserResolution)
{
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  MapComparisonOptions tolerant;
  tolerant.tolerance_nodes = 1;
  const MapAgreement agreement =
      compareMaps(mapped(world, 0.05, 0.01), mapped(world, 0.1, 0.0), tolerant);
  EXPECT_GT(agreement.occupiedPrecision(), 0.99);
  EXPECT_GT(agreement.occupiedRecall(), 0.99);
  EXPECT_GT(agreement.freePrecision(), 0.99);
  EXPECT_GT(agreement.freeRecall(), 0.95);
}

TEST(MapComparison, RefusesResolutionsThatDoNotFit)
{
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  EXPECT_THROW((void)compareMaps(mapped(world, 0.07, 0.0), mapped(world, 0.1, 0.0), {}),
               InvalidArgument);
}

}  // namespace
}  // namespace kr3::navigation
