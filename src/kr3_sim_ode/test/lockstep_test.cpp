#include "kr3_sim_ode/lockstep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint64_t kTick = 10;
constexpr double kTimeout = 5.0;
}  // namespace

TEST(Lockstep, GoesOnWithoutConsumers)
{
  const Lockstep lockstep(0, kTick, {});
  EXPECT_TRUE(lockstep.isReady(0));
}

TEST(Lockstep, WaitsForEveryConsumerAtEveryTick)
{
  Lockstep lockstep(0, kTick, {});
  EXPECT_EQ(lockstep.add("a", 0, kTimeout, 90, 0.0).first_ns, 100U);
  lockstep.add("b", 0, kTimeout, 90, 0.0);
  EXPECT_TRUE(lockstep.isReady(90)) << "nothing is due yet";
  lockstep.advanced(100, 0.0);
  lockstep.acknowledge("a", 100, 0, 100);
  EXPECT_FALSE(lockstep.isReady(100));
  EXPECT_THAT(lockstep.waitingFor(100), ElementsAre("b"));
  lockstep.acknowledge("b", 100, 0, 100);
  EXPECT_TRUE(lockstep.isReady(100));
  lockstep.advanced(110, 0.0);
  EXPECT_FALSE(lockstep.isReady(110)) << "an acknowledgement holds for its stamp";
  lockstep.acknowledge("a", 100, 0, 110);
  lockstep.acknowledge("b", 110, 0, 110);
  EXPECT_THAT(lockstep.waitingFor(110), ElementsAre("a")) << "an old stamp says nothing new";
}

TEST(Lockstep, WaitsAtMultiplesOfThePeriodSinceTheStartOnly)
{
  Lockstep lockstep(1000, kTick, {});
  const Lockstep::Schedule schedule = lockstep.add("slow", 25, kTimeout, 1040, 0.0);
  EXPECT_EQ(schedule.period_ns, 30U) << "rounded up to ticks";
  EXPECT_EQ(schedule.first_ns, 1060U);
  for (std::uint64_t now = 1040; now <= 1200; now += kTick)
  {
    lockstep.advanced(now, 0.0);
    const bool due = now >= 1060 && (now - 1000) % 30 == 0;
    EXPECT_EQ(lockstep.isReady(now), !due) << now;
    if (due)
    {
      lockstep.acknowledge("slow", now, 0, now);
      EXPECT_TRUE(lockstep.isReady(now));
    }
  }
}

TEST(Lockstep, WaitsForTheCommandsThatWereSent)
{
  Lockstep lockstep(0, kTick, {});
  lockstep.add("driver", 0, kTimeout, 0, 0.0);
  lockstep.advanced(10, 0.0);
  lockstep.acknowledge("driver", 10, 2, 10);
  EXPECT_FALSE(lockstep.isReady(10));
  lockstep.noteCommand("driver");
  lockstep.noteCommand("somebody_else");
  EXPECT_FALSE(lockstep.isReady(10));
  lockstep.noteCommand("driver");
  EXPECT_TRUE(lockstep.isReady(10));
}

TEST(Lockstep, DoesNotBeginBeforeTheRequiredConsumersAreThere)
{
  Lockstep lockstep(0, kTick, {"a", "b"});
  EXPECT_THAT(lockstep.waitingFor(0), ElementsAre("a", "b"));
  lockstep.add("a", 100, kTimeout, 0, 0.0);
  EXPECT_FALSE(lockstep.isReady(0));
  lockstep.add("b", 100, kTimeout, 0, 0.0);
  EXPECT_TRUE(lockstep.isReady(0));
}

TEST(Lockstep, RemovesAConsumerThatDoesNotAnswerInTime)
{
  Lockstep lockstep(0, kTick, {});
  lockstep.add("dead", 0, 2.0, 0, 10.0);
  lockstep.add("alive", 0, 2.0, 0, 10.0);
  EXPECT_THAT(lockstep.expire(0, 20.0), IsEmpty()) << "not due";
  lockstep.advanced(10, 20.0);
  lockstep.acknowledge("alive", 10, 0, 10);
  EXPECT_THAT(lockstep.expire(10, 21.9), IsEmpty());
  EXPECT_THAT(lockstep.expire(10, 22.1), ElementsAre("dead"));
  EXPECT_THAT(lockstep.consumers(), ElementsAre("alive"));
  EXPECT_TRUE(lockstep.isReady(10));
}

TEST(Lockstep, StartsAnewWhoRegistersAgain)
{
  Lockstep lockstep(0, kTick, {});
  lockstep.add("a", 0, kTimeout, 0, 0.0);
  lockstep.advanced(10, 0.0);
  lockstep.acknowledge("a", 10, 7, 10);  // seven commands that died with it
  EXPECT_FALSE(lockstep.isReady(10));
  lockstep.add("a", 0, kTimeout, 10, 0.0);
  lockstep.advanced(20, 0.0);
  lockstep.acknowledge("a", 20, 0, 20);
  EXPECT_TRUE(lockstep.isReady(20));
}

TEST(Lockstep, RefusesWhatMakesNoSense)
{
  Lockstep lockstep(0, kTick, {});
  EXPECT_THROW(Lockstep(0, 0, {}), InvalidArgument);
  EXPECT_THROW(Lockstep(0, kTick, {"a", "a"}), InvalidArgument);
  EXPECT_THROW(lockstep.add("", 0, kTimeout, 0, 0.0), InvalidArgument);
  EXPECT_THROW(lockstep.add("a", 0, 0.0, 0, 0.0), InvalidArgument);
  EXPECT_THROW(lockstep.acknowledge("nobody", 0, 0, 0), NotFound);
  EXPECT_THROW(lockstep.remove("nobody"), NotFound);
  lockstep.add("a", 0, kTimeout, 0, 0.0);
  EXPECT_THROW(lockstep.acknowledge("a", 10, 0, 0), InvalidArgument) << "from the future";
}

}  // namespace kr3::sim
