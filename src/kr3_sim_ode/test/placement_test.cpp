#include "kr3_sim_ode/placement.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";
using testing::HasSubstr;

class Placement : public testing::Test
{
protected:
  Building building = loadBuilding(kData + "two_rooms.yaml");
  std::vector<ObjectModel> models = loadObjectModels(kData + "objects.yaml");
};

template <typename ErrorType, typename Work>
std::string messageOf(Work work)
{
  try
  {
    work();
  }
  catch (const ErrorType& e)
  {
    return e.what();
  }
  return "no such error";
}
}  // namespace

TEST_F(Placement, OverridesDefaultsAndAddsWhatHasNone)
{
  const auto result =
      overriddenAssignments(building.objects, {"book=right", "crate=left"}, building, models);
  ASSERT_EQ(result.size(), 3U);
  EXPECT_EQ(result[0].place, "right");
  EXPECT_EQ(result[1].place, "right");
  EXPECT_EQ(result[2].object, "crate");
}

TEST_F(Placement, RefusesUnknownNamesAndMalformedEntries)
{
  const auto error = [&](const std::string& entry) {
    return messageOf<Error>(
        [&] { (void)overriddenAssignments(building.objects, {entry}, building, models); });
  };
  EXPECT_THAT(error("book=attic"),
              HasSubstr("unknown place 'attic', expected one of: left, right"));
  EXPECT_THAT(error("bok=left"), HasSubstr("unknown object 'bok', expected one of: book, cup"));
  EXPECT_THAT(error("book"), HasSubstr("not of the form object=place"));
  EXPECT_THAT(messageOf<InvalidArgument>([&] {
                (void)overriddenAssignments({}, {"book=left", "book=right"}, building, models);
              }),
              HasSubstr("twice"));
}

TEST_F(Placement, SaysWhenNothingIsFree)
{
  std::mt19937_64 generator(1);
  std::vector<ObjectState> objects;
  const ObjectModel& cup = findModel(models, "cup");
  const auto fill = [&] {
    for (int i = 0; i < 50; ++i)
    {
      const Pose pose = freeSurfacePose(building, "right", cup, objects, models, generator);
      objects.push_back({"cup" + std::to_string(i), "cup", pose});
    }
  };
  EXPECT_THAT(messageOf<FailedPrecondition>(fill),
              HasSubstr("no free surface for 'cup' in 'right'"));
  EXPECT_GE(objects.size(), 2U);
  EXPECT_LE(objects.size(), 5U) << "the table is 1.4 m wide and objects keep 0.3 m apart";
}

TEST_F(Placement, DrawsFreeFloor)
{
  std::mt19937_64 generator(1);
  for (int i = 0; i < 50; ++i)
  {
    const Pose2 pose = freeFloorPose(building, "right", 0.4, generator);
    EXPECT_EQ(building.placeAt(pose.x, pose.y)->name, "right");
    EXPECT_GE(Obstacles(building).clearance(pose.x, pose.y, 1.0), 0.4);
  }
  EXPECT_THROW((void)freeFloorPose(building, "right", 3.0, generator), FailedPrecondition);
}

TEST(Obstacles, HaveTheClearanceOfTheNearestBox)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  std::vector<Box> boxes = wallsOf(building);
  for (const Furniture& furniture : building.furniture)
  {
    boxes.push_back(furniture.box());
  }
  const Obstacles obstacles(building);
  std::mt19937_64 generator(3);
  for (int i = 0; i < 500; ++i)
  {
    const double x = uniform(generator, -3.0, 11.0);  // outside of the building too
    const double y = uniform(generator, -3.0, 7.0);
    double nearest = 1.5;
    for (const Box& box : boxes)
    {
      nearest = std::min(nearest, planarDistance(box, x, y));
    }
    EXPECT_DOUBLE_EQ(obstacles.clearance(x, y, 1.5), nearest) << x << " " << y;
  }
}

}  // namespace kr3::sim
