// What a simulator in lockstep hears from a node, with this test as the simulator.

#include "kr3_common/ros/lockstep_consumer.hpp"

#include <memory>
#include <mutex>

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <kr3_msgs/Acknowledgement.h>
#include <kr3_msgs/LockstepState.h>
#include <kr3_msgs/RegisterConsumer.h>
#include <kr3_msgs/Status.h>
#include <kr3_msgs/UnregisterConsumer.h>

namespace
{

constexpr char kName[] = "lockstep_consumer";  // of this node

class Simulator : public testing::Test
{
protected:
  Simulator()
  {
    ros::Time::setNow(ros::Time(100.0));
    register_ = nh_.advertiseService("lockstep/register", &Simulator::onRegister, this);
    unregister_ = nh_.advertiseService("lockstep/unregister", &Simulator::onUnregister, this);
    acknowledge_ = nh_.subscribe<kr3_msgs::Acknowledgement>(
        "lockstep/acknowledge", 100, [this](const kr3_msgs::AcknowledgementConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          last_s_ = message->stamp.toSec();
        });
    state_ = nh_.advertise<kr3_msgs::LockstepState>("lockstep/state", 1, true);
    spinner_.start();
    consumer_ = std::make_unique<kr3::LockstepConsumer>(nh_);
  }

  /// Sets simulated time and gives the node some wall time. @return the last stamp acknowledged, s
  double at(double simulated_s, double wall_s = 0.2)
  {
    ros::Time::setNow(ros::Time(simulated_s));
    ros::WallDuration(wall_s).sleep();
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_s_;
  }

  bool onRegister(kr3_msgs::RegisterConsumer::Request& request,
                  kr3_msgs::RegisterConsumer::Response& response)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++registrations_;
    response.status.code = kr3_msgs::Status::OK;
    return request.name == kName;
  }

  bool onUnregister(kr3_msgs::UnregisterConsumer::Request& /*request*/,
                    kr3_msgs::UnregisterConsumer::Response& response)
  {
    response.status.code = kr3_msgs::Status::OK;
    return true;
  }

  int registrations()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return registrations_;
  }

  ros::NodeHandle nh_;
  std::mutex mutex_;
  int registrations_ = 0;
  double last_s_ = 0.0;
  ros::ServiceServer register_;
  ros::ServiceServer unregister_;
  ros::Subscriber acknowledge_;
  ros::Publisher state_;
  ros::AsyncSpinner spinner_{2};
  std::unique_ptr<kr3::LockstepConsumer> consumer_;
};

TEST_F(Simulator, IsNotHeldByANodeThatIsIdle)
{
  EXPECT_DOUBLE_EQ(at(101.0), 101.0);
  EXPECT_DOUBLE_EQ(at(500.0), 500.0);
}

TEST_F(Simulator, GoesNoFasterThanWallTimeWhileANodeIsPaced)
{
  EXPECT_DOUBLE_EQ(at(101.0), 101.0);
  consumer_->pace();
  EXPECT_DOUBLE_EQ(at(102.0), 101.0);
  EXPECT_DOUBLE_EQ(at(102.0, 1.2), 102.0);
  EXPECT_DOUBLE_EQ(at(200.0), 102.0);
  consumer_->release();
  EXPECT_DOUBLE_EQ(at(200.0), 200.0);
}

TEST_F(Simulator, IsJoinedAgainByANodeThatItLeftBehind)
{
  EXPECT_EQ(registrations(), 1);
  kr3_msgs::LockstepState state;
  state.consumers = {kName};
  state_.publish(state);
  at(101.0);
  EXPECT_EQ(registrations(), 1);
  state.consumers.clear();
  state_.publish(state);
  at(102.0);
  EXPECT_EQ(registrations(), 2);
}

}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, kName);
  ros::param::set("/use_sim_time", true);
  const ros::NodeHandle nh;
  return RUN_ALL_TESTS();
}
