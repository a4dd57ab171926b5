// What each skill of SkillNode does.
#include <algorithm>
#include <iomanip>
#include <sstream>

#include <std_msgs/String.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/skills_approach.hpp"
#include "skill_node.hpp"

namespace kr3::executive::skills
{
namespace
{

constexpr char kFound[] = "found";
constexpr char kNotFound[] = "not_found";
constexpr char kSucceeded[] = "succeeded";
constexpr char kFailed[] = "failed";
constexpr double kGlance = 0.35;  // rad to either side when an object is not where it was

void checkCount(const std::vector<std::string>& arguments, std::size_t least, std::size_t most,
                const std::string& expected)
{
  if (arguments.size() < least || arguments.size() > most)
    throw InvalidArgument("found " + std::to_string(arguments.size()) + " arguments, expected " +
                          expected);
}

}  // namespace

SkillNode::Outcome SkillNode::search(const Arguments& arguments, const Run& run)
{
  checkCount(arguments, 2, 2, "[cell, object]");
  const std::string& cell = arguments[0];
  const std::string& object = arguments[1];
  checkObject(object);
  const CellMap cells = robot_.cells(run.interruption);
  returnTo(cell, cells, run);
  const SearchLog log = lookRound(object, run);
  if (log.best() && log.best()->probability >= config_.search.accept_probability)
    last_sighting_[object] = *log.best();
  const SearchResult result = log.result(cells, cell, config_.search);
  Outcome outcome{result.found ? kFound : kNotFound, {}, result.confidence};
  if (log.best())
    ROS_INFO("%s seen at (%.2f, %.2f) with probability %.2f", object.c_str(), log.best()->p_map.x,
             log.best()->p_map.y, log.best()->probability);
  if (result.where)
    outcome.observation.push_back(*result.where);
  return outcome;
}

void SkillNode::returnTo(const std::string& cell, const CellMap& cells, const Run& run)
{
  const Pose pose = robot_.pose(run.interruption);
  const double outside = cells.distanceTo(cell, pose.point());
  if (outside <= config_.cell_margin_m)
    return;
  const auto refuse = [&](const std::string& why) {
    std::ostringstream text;
    text << "the robot is " << std::fixed << std::setprecision(2) << outside << " m outside '"
         << cell << "'" << why;
    throw FailedPrecondition(text.str());
  };
  if (outside > config_.return_margin_m)
    refuse("");
  const CellArea& area = cells.at(cell);
  run.report("going back into " + cell, 0.0);
  if (!robot_.driveTo({area.stand.x, area.stand.y, pose.yaw}, run.interruption))
    refuse(" and found no way back");
}

SearchLog SkillNode::lookRound(const std::string& object, const Run& run)
{
  robot_.openEyes();
  SearchLog log;
  const double view = robot_.viewAngle(run.interruption);
  const std::vector<double> headings = lookHeadings(robot_.pose(run.interruption).yaw, view,
                                                    std::min(config_.view_overlap_rad, 0.8 * view));
  for (std::size_t i = 0; i < headings.size() && !log.sure(config_.search); ++i)
  {
    run.report("looking round for " + object,
               static_cast<double>(i) / static_cast<double>(headings.size()));
    if (i > 0)
      robot_.turnTo(headings[i], run.interruption);
    for (int k = 0; k < config_.images_per_heading && !log.sure(config_.search); ++k)
      addSightings(object, log, run);
  }
  return log;
}

bool SkillNode::addSightings(const std::string& object, SearchLog& log, const Run& run)
{
  bool seen = false;
  for (const Seen& each : robot_.look(run.interruption))
  {
    notice(each);
    if (each.name != object)
      continue;
    seen = seen || each.probability >= config_.search.accept_probability;
    if (each.p_map)
      log.add({*each.p_map, each.probability});
  }
  return seen;
}

void SkillNode::notice(const Seen& seen)
{
  if (!seen.p_map || seen.probability < config_.search.accept_probability ||
      objects_.count(seen.name) == 0)
    return;
  const Sighting sighting{*seen.p_map, seen.probability};
  const auto [known, is_new] = noticed_.emplace(seen.name, sighting);
  if (!is_new && sighting.probability > known->second.probability)
    known->second = sighting;
}

std::vector<kr3_msgs::Sighting> SkillNode::seenByTheWay(const Arguments& arguments,
                                                        const Outcome& outcome, const Run& run)
{
  std::vector<kr3_msgs::Sighting> told;
  if (seen_literal_.empty() || noticed_.empty())
    return told;
  const CellMap cells = robot_.cells(run.interruption);
  const std::string room =
      cells.holding(robot_.pose(run.interruption).point(), {}, {}, 0.0, 0.0).room;
  for (const auto& [object, sighting] : noticed_)
  {
    // What was asked for is told by the outcome, unless it is somewhere else.
    const bool asked = std::find(arguments.begin(), arguments.end(), object) != arguments.end();
    if (asked && outcome.label != kNotFound)
      continue;
    kr3_msgs::Sighting message;
    message.literal = seen_literal_;
    const auto fill = [&message](const std::string& place, const std::string& name) {
      message.literal.replace(message.literal.find(place), place.size(), name);
    };
    fill("${object}", object);
    fill("${cell}",
         cells.holding(sighting.p_map, room, {}, 0.0, config_.search.other_room_penalty_m).name);
    message.confidence = std::min(sighting.probability, 1.0);
    told.push_back(std::move(message));
  }
  return told;
}

SkillNode::Outcome SkillNode::grasp(const Arguments& arguments, const Run& run)
{
  checkCount(arguments, 1, 2, "[object] or [object, cell]");
  const std::string& object = arguments[0];
  checkObject(object);
  if (arguments.size() > 1)
    checkCell(arguments[1], run);
  if (robot_.holding())
    throw FailedPrecondition("the gripper holds something already");
  if (last_sighting_.count(object) == 0)
  {
    const SearchLog log = lookRound(object, run);
    if (!log.best() || log.best()->probability < config_.search.accept_probability)
      return {kFailed, {}, config_.search.miss_confidence};
    last_sighting_[object] = *log.best();
  }
  Point target = last_sighting_.at(object).p_map;
  run.report("approaching " + object, 0.2);
  if (!approach(target, run))
    return {kFailed, {}, 1.0};
  run.report("looking at " + object, 0.6);
  robot_.openEyes();
  if (!lookAgain(object, target, run))
  {
    last_sighting_.erase(object);
    return {kFailed, {}, 1.0};
  }
  const Pose stand = robot_.pose(run.interruption);
  robot_.turnTo(bearing(stand.point(), target), run.interruption);
  const double missing = distance(stand.point(), target) - config_.grasp_distance_m;
  if (missing > 0.0)
    robot_.creep(missing, run.interruption);
  run.report("closing the gripper", 0.8);
  const bool holding = robot_.closeGripper();
  if (holding)
    last_sighting_.erase(object);
  robot_.creep(-config_.back_off_m, run.interruption);
  return {holding ? kSucceeded : kFailed, {}, 1.0};
}

bool SkillNode::approach(const Point& object_map, const Run& run)
{
  const std::vector<Pose> poses = approachPoses(object_map, robot_.pose(run.interruption),
                                                robot_.grid(run.interruption), config_.approach);
  const std::size_t tries =
      std::min(poses.size(), static_cast<std::size_t>(config_.max_approaches));
  for (std::size_t i = 0; i < tries; ++i)
    if (robot_.driveTo(poses[i], run.interruption))
      return true;
  ROS_WARN("none of %zu poses within the gripper's reach of (%.2f, %.2f) can be reached",
           poses.size(), object_map.x, object_map.y);
  return false;
}

bool SkillNode::lookAgain(const std::string& object, Point& object_map, const Run& run)
{
  const double ahead = bearing(robot_.pose(run.interruption).point(), object_map);
  for (const double offset : {0.0, kGlance, -kGlance})
  {
    robot_.turnTo(ahead + offset, run.interruption);
    SearchLog log;
    if (!addSightings(object, log, run))
      continue;
    if (log.best())
    {
      object_map = log.best()->p_map;
      last_sighting_[object] = *log.best();
    }
    return true;  // so near that the image cuts it off: it is where it was
  }
  return false;
}

SkillNode::Outcome SkillNode::putDown(const Arguments& arguments, const Run& run)
{
  checkCount(arguments, 1, 2, "[object] or [object, cell]");
  checkObject(arguments[0]);
  if (arguments.size() > 1)
    checkCell(arguments[1], run);
  if (!robot_.holding())
    throw FailedPrecondition("the gripper holds nothing");
  // Where there is no room ahead, there may be some to the side.
  constexpr int kDirections = 6;
  const double ahead = robot_.pose(run.interruption).yaw;
  for (int i = 0; i < kDirections; ++i)
  {
    run.report("looking for room", static_cast<double>(i) / kDirections);
    if (i > 0)
      robot_.turnTo(ahead + i * 2.0 * M_PI / kDirections, run.interruption);
    if (robot_.openGripper())
    {
      robot_.creep(-config_.back_off_m, run.interruption);
      return {kSucceeded, {}, 1.0};
    }
  }
  return {kFailed, {}, 1.0};
}

SkillNode::Outcome SkillNode::handOver(const Arguments& arguments, const Run& run)
{
  checkCount(arguments, 1, 2, "[object] or [object, cell]");
  const std::string& object = arguments[0];
  checkObject(object);
  if (robot_.holding())
    throw FailedPrecondition("the gripper holds something already");
  const auto say = [&](const std::string& text) {
    std_msgs::String message;
    message.data = text;
    request_.publish(message);
  };
  robot_.notify([&] { answer_ = Answer::kNone; });
  say("Please put " + object + " into the gripper, then confirm, or refuse.");
  run.report("waiting for a person", 0.0);
  Answer answer = Answer::kNone;
  try
  {
    robot_.waitFor(
        [&] {
      answer = answer_;
      return answer != Answer::kNone;
        },
        "a person", run.interruption, true);
  }
  catch (const DeadlineExceeded&)
  {
    say("");
    return {kFailed, {}, 1.0};
  }
  catch (...)
  {
    say("");
    throw;
  }
  say("");
  if (answer == Answer::kRefused)
    throw Unavailable("the person who was asked refused to hand over " + object);
  return {robot_.closeGripper() ? kSucceeded : kFailed, {}, 1.0};
}

}  // namespace kr3::executive::skills
