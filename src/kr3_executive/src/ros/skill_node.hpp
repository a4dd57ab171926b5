#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <kr3_common/ros/monotonic_clock.hpp>
#include <kr3_msgs/ExecuteSkillAction.h>
#include <kr3_msgs/Sighting.h>

#include "kr3_executive/skills_search.hpp"
#include "skill_node_config.hpp"
#include "skill_robot.hpp"

namespace kr3::executive::skills
{

/// The skills that are composed of the robot's other nodes: search, grasp, put down, hand over.
///
/// Each skill runs on its action server's thread, one at a time; messages arrive on the spinner's
/// thread. Needs a spinner that runs beside it.
class SkillNode
{
public:
  /// @throws Unavailable, InvalidArgument  the objects file cannot be read
  SkillNode(const ros::NodeHandle& nh, const SkillNodeConfig& config);
  ~SkillNode();
  SkillNode(const SkillNode&) = delete;
  SkillNode& operator=(const SkillNode&) = delete;

private:
  using Server = actionlib::SimpleActionServer<kr3_msgs::ExecuteSkillAction>;
  using Arguments = std::vector<std::string>;

  struct Outcome
  {
    std::string label;
    std::vector<std::string> observation;
    double confidence = 1.0;
  };
  /// What a skill needs while it runs.
  struct Run
  {
    Interruption interruption;
    std::function<void(const std::string& phase, double progress)> report;
  };
  using Skill = Outcome (SkillNode::*)(const Arguments&, const Run&);
  /// One action server with what it does.
  struct Offer
  {
    std::string name;
    Skill skill;
    double time_limit_s = 0.0;
    std::unique_ptr<Server> server;
  };

  void offer(const std::string& name, const std::string& topic, Skill skill, double time_limit_s);
  void serve(Offer& offer, const kr3_msgs::ExecuteSkillGoal& goal);

  [[nodiscard]] Outcome search(const Arguments& arguments, const Run& run);
  [[nodiscard]] Outcome grasp(const Arguments& arguments, const Run& run);
  [[nodiscard]] Outcome putDown(const Arguments& arguments, const Run& run);
  [[nodiscard]] Outcome handOver(const Arguments& arguments, const Run& run);

  /// Drives back into the cell that is to be searched when something left it nearby.
  /// @throws FailedPrecondition  the robot is farther away, or there is no way
  void returnTo(const std::string& cell, const CellMap& cells, const Run& run);
  /// Turns round and looks for `object` until it is surely seen.
  [[nodiscard]] SearchLog lookRound(const std::string& object, const Run& run);
  /// Drives to a pose from which `object` can be grasped; false when there is none.
  [[nodiscard]] bool approach(const Point& object_map, const Run& run);
  /// Looks at an object nearby once more. False when it is not there.
  [[nodiscard]] bool lookAgain(const std::string& object, Point& object_map, const Run& run);
  /// Adds what one image shows of `object`. @return whether it was seen at all, if only its
  /// direction
  bool addSightings(const std::string& object, SearchLog& log, const Run& run);

  /// Keeps the best sighting of each known object in an image.
  void notice(const Seen& seen);
  /// What was seen by the way during the skill, in the words of the domain.
  [[nodiscard]] std::vector<kr3_msgs::Sighting> seenByTheWay(const Arguments& arguments,
                                                             const Outcome& outcome,
                                                             const Run& run);

  void checkObject(const std::string& name) const;
  void checkCell(const std::string& name, const Run& run);

  SkillNodeConfig config_;
  std::set<std::string> objects_;
  std::string seen_literal_;  ///< with ${object} and ${cell}; empty: nothing is told
  SkillRobot robot_;
  std::map<std::string, Sighting> last_sighting_;  ///< by object; used by the running skill only
  std::map<std::string, Sighting> noticed_;        ///< the best of each object in this skill
  MonotonicClock clock_;                           ///< of time limits and durations
  std::mutex running_;                             ///< held by the skill that moves the robot
  /// What the person who was asked answered; changed by SkillRobot::notify().
  enum class Answer
  {
    kNone,
    kConfirmed,
    kRefused,
  };
  Answer answer_ = Answer::kNone;

  std::atomic<unsigned> num_done_{0};
  std::atomic<unsigned> num_failed_{0};
  std::atomic<const char*> current_{""};

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher request_;
  ros::ServiceServer confirm_;
  ros::ServiceServer refuse_;
  ros::WallTimer diagnostics_timer_;
  std::vector<std::unique_ptr<Offer>> offers_;
};

}  // namespace kr3::executive::skills
