#!/usr/bin/python3
"""Contract of navigation_node in a given map: starts, answers, refuses bad goals with a Status, survives, stops."""

import math
import os
import pathlib
import signal
import subprocess
import sys
import unittest
import xmlrpc.client

import actionlib
import rosgraph
import rospy
import rostest
from actionlib import CommState
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseWithCovarianceStamped
from kr3_msgs.msg import CellArray, ExecuteSkillAction, ExecuteSkillGoal, Status
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from fake_robot import FakeRobot  # noqa: E402

ANSWER = 30.0  # wall seconds that anything may take to answer


def wait_until(condition, deadline_s: float = ANSWER) -> bool:
    """Polls on the wall clock: simulated time is what is being tested."""
    end = rospy.get_rostime().to_sec() + 10.0 * deadline_s
    rate = rospy.Rate(20)
    while not condition():
        if rospy.get_rostime().to_sec() > end:
            return False
        rate.sleep()
    return True


class NavigationNodeTest(unittest.TestCase):
    robot = None

    @classmethod
    def setUpClass(cls):
        cls.robot = FakeRobot(2.0, 3.0, 0.0)
        cls.move_to = actionlib.SimpleActionClient("skills/move_to", ExecuteSkillAction)
        cls.move_base = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        rospy.wait_for_message("pose", PoseWithCovarianceStamped, timeout=ANSWER)
        assert cls.move_to.wait_for_server(rospy.Duration(10.0 * ANSWER))
        assert cls.move_base.wait_for_server(rospy.Duration(10.0 * ANSWER))

    def skill(self, *arguments, limit=0.0):
        goal = ExecuteSkillGoal(skill="move_to", arguments=list(arguments))
        goal.time_limit = rospy.Duration(limit)
        return goal

    def finished(self, client, goal):
        """Send a goal and wait for its end; its handle.

        By the handle: of a goal that is refused at once the simple client drops the transitions that come before it has
        stored the handle, and waits for ever.
        """
        client.send_goal(goal)
        done = wait_until(lambda: client.gh.get_comm_state() == CommState.DONE, 10.0 * ANSWER)
        self.assertTrue(done, "no result")
        return client.gh

    def run_skill(self, *arguments, limit=0.0):
        return self.finished(self.move_to, self.skill(*arguments, limit=limit)).get_result()

    def pose_goal(self, x, y, yaw, frame="map"):
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = frame
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
        goal.target_pose.pose.orientation.z = math.sin(yaw / 2.0)
        goal.target_pose.pose.orientation.w = math.cos(yaw / 2.0)
        return goal

    def run_move_base(self, goal):
        handle = self.finished(self.move_base, goal)
        return handle.get_terminal_state(), handle.get_goal_status_text()

    def test_publishes_map_and_cells_for_late_listeners(self):
        array = rospy.wait_for_message("cells", CellArray, timeout=ANSWER)
        self.assertEqual(
            [cell.name for cell in array.cells],
            [f"{room}_c{i}" for room in ("left", "right") for i in range(4)],
        )
        self.assertEqual(array.header.frame_id, "map")
        self.assertEqual(len(array.travel_distance), 64)
        self.assertEqual(array.travel_distance[3], array.travel_distance[24])
        self.assertIn("right_c0", array.cells[1].neighbors)
        grid = rospy.wait_for_message("map", OccupancyGrid, timeout=ANSWER)
        self.assertEqual(len(grid.data), grid.info.width * grid.info.height)
        octomap = rospy.wait_for_message("octomap_binary", UInt8MultiArray, timeout=ANSWER)
        self.assertTrue(bytes(octomap.data).startswith(b"# Octomap OcTree binary file"))

    def test_drives_to_a_cell_in_the_other_room(self):
        result = self.run_skill("right_c3")
        self.assertEqual(result.status.code, Status.OK)
        self.assertEqual(result.outcome, "reached")
        self.assertEqual(result.observation, ["right_c3"])
        self.assertGreater(result.confidence, 0.9)
        self.assertGreater(result.duration_s, 1.0)
        self.assertTrue(6.0 <= self.robot.x <= 8.0 and 2.0 <= self.robot.y <= 4.0)

    def test_ends_at_the_pose_of_a_move_base_goal(self):
        state, text = self.run_move_base(self.pose_goal(6.0, 1.0, -2.0))
        self.assertEqual(state, GoalStatus.SUCCEEDED, text)
        self.assertLess(math.hypot(self.robot.x - 6.0, self.robot.y - 1.0), 0.12)
        turn = self.robot.yaw + 2.0
        self.assertLess(abs(math.atan2(math.sin(turn), math.cos(turn))), 0.08)

    def test_refuses_an_unknown_cell_and_names_the_nearest(self):
        result = self.run_skill("rihgt_c1")
        self.assertEqual(result.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("'right_c1'", result.status.message)
        self.assertEqual(self.run_skill("left_c3").outcome, "reached")  # it survived

    def test_refuses_a_wrong_number_of_arguments(self):
        self.assertEqual(self.run_skill().status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(self.run_skill("left_c1", "x").status.code, Status.INVALID_ARGUMENT)

    def test_refuses_a_goal_in_another_frame_and_a_broken_one(self):
        state, text = self.run_move_base(self.pose_goal(1.0, 1.0, 0.0, frame="odom"))
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("'odom'", text)
        broken = self.pose_goal(1.0, 3.0, 0.0)
        broken.target_pose.pose.orientation.w = 0.0
        broken.target_pose.pose.orientation.z = 0.0
        state, text = self.run_move_base(broken)
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("quaternion", text)

    def test_says_why_a_goal_is_unreachable(self):
        for x, why in ((1.2, "from an obstacle"), (50.0, "outside the map")):
            state, text = self.run_move_base(self.pose_goal(x, 0.8, 0.0))
            self.assertEqual(state, GoalStatus.ABORTED)
            self.assertIn("unreachable", text)
            self.assertIn(why, text)

    def test_refuses_poses_that_are_none(self):
        for value in (math.nan, math.inf):
            state, text = self.run_move_base(self.pose_goal(value, 1.0, 0.0))
            self.assertEqual(state, GoalStatus.ABORTED)
            self.assertIn("finite", text)
        before = rospy.wait_for_message("pose", PoseWithCovarianceStamped, timeout=ANSWER)
        publisher = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=10)
        self.assertTrue(wait_until(lambda: publisher.get_num_connections() > 0))
        for frame, x, w in (
            ("map", math.nan, 1.0),
            ("map", 1e6, 1.0),
            ("map", 1.0, 0.0),
            ("odom", 1.0, 1.0),
        ):
            message = PoseWithCovarianceStamped()
            message.header.frame_id = frame
            message.pose.pose.position.x, message.pose.pose.position.y = x, 1.0
            message.pose.pose.orientation.w = w
            publisher.publish(message)
        message.header.frame_id = "map"
        message.pose.covariance = [math.nan] * 36
        publisher.publish(message)
        for _ in range(5):
            after = rospy.wait_for_message("pose", PoseWithCovarianceStamped, timeout=ANSWER)
        self.assertLess(abs(after.pose.pose.position.x - before.pose.pose.position.x), 0.1)
        self.assertLess(abs(after.pose.pose.position.y - before.pose.pose.position.y), 0.1)

    def test_survives_scans_of_nonsense(self):
        publisher = rospy.Publisher("scan", LaserScan, queue_size=10)
        self.assertTrue(wait_until(lambda: publisher.get_num_connections() > 0))
        for frame in ("laser", "nowhere"):
            for ranges in ([], [math.nan] * 360, [-1.0] * 360, [1.0] * 5, [math.inf] * 200000):
                scan = LaserScan(angle_max=6.27, angle_increment=0.017466, range_max=12.0)
                scan.header.stamp, scan.header.frame_id = rospy.Time.now(), frame
                scan.ranges = ranges
                publisher.publish(scan)
        self.assertEqual(self.run_skill("left_c3").outcome, "reached")

    def test_cancel_stops_the_wheels(self):
        self.move_to.send_goal(self.skill(self.far_cell()))
        self.assertTrue(wait_until(lambda: self.robot.commands and self.moving()))
        self.move_to.cancel_goal()
        self.assertTrue(self.move_to.wait_for_result(rospy.Duration(10.0 * ANSWER)))
        self.assertEqual(self.move_to.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual(self.move_to.get_result().status.code, Status.CANCELLED)
        self.assertTrue(wait_until(lambda: self.robot.commands[-1] == (0.0, 0.0)))

    def test_a_goal_of_the_other_server_preempts(self):
        self.move_to.send_goal(self.skill(self.far_cell()))
        self.assertTrue(wait_until(self.moving))
        state, text = self.run_move_base(self.pose_goal(2.0, 3.0, 0.0))
        self.assertEqual(state, GoalStatus.SUCCEEDED, text)
        self.assertEqual(self.move_to.get_state(), GoalStatus.PREEMPTED)

    def test_keeps_the_time_limit(self):
        result = self.run_skill(self.far_cell(), limit=1.0)
        self.assertEqual(result.status.code, Status.DEADLINE_EXCEEDED)
        self.assertEqual(len(result.observation), 1)

    def test_save_map_without_a_file_name_fails(self):
        rospy.wait_for_service("save_map", timeout=ANSWER)
        response = rospy.ServiceProxy("save_map", Trigger)()
        self.assertFalse(response.success)
        self.assertIn("map_out", response.message)

    def test_a_bad_start_is_one_clear_error(self):
        building = rospy.get_param("/navigation_node/building")
        missing = self.start_and_fail("_building:=" + building, "_map:=/nowhere/map.bt")
        self.assertIn("/nowhere/map.bt does not exist", missing)
        self.assertIn("./kr3 map data", missing)
        bad = self.start_and_fail("_building:=" + building, "_pose_source:=gps", "_mpa:=x")
        self.assertIn("pose_source must be", bad)
        self.assertIn("mpa is unknown", bad)

    def test_finds_rooms_in_the_map_when_there_are_no_labels(self):
        node = subprocess.Popen(
            [
                "rosrun",
                "kr3_navigation",
                "navigation_node",
                "__name:=navigation_node",
                "__ns:=/unlabelled",
                "_place_source:=map",
                "_map:=" + rospy.get_param("/navigation_node/map"),
            ]
        )
        try:
            array = rospy.wait_for_message("/unlabelled/cells", CellArray, timeout=ANSWER)
        finally:
            node.send_signal(signal.SIGINT)
            node.wait(ANSWER)
        self.assertEqual(
            [cell.name for cell in array.cells],
            [f"room_{room}_c{i}" for room in range(2) for i in range(4)],
        )
        self.assertTrue(all(math.isfinite(way) for way in array.travel_distance))
        bad = self.start_and_fail("_place_source:=labels", "_map:=/nowhere.bt")
        self.assertIn("place_source must be 'building' or 'map'", bad)
        missing = self.start_and_fail("_place_source:=map", "_map:=/nowhere.bt")
        self.assertIn("/nowhere.bt does not exist", missing)
        mapping = self.start_and_fail("_place_source:=map", "_pose_source:=mapping")
        self.assertIn("must be 'building' while a map is built", mapping)

    def test_zz_stops_the_wheels_when_interrupted(self):
        self.move_to.send_goal(self.skill(self.far_cell()))
        self.assertTrue(wait_until(self.moving))
        uri = rosgraph.Master(rospy.get_name()).lookupNode("/navigation_node")
        pid = xmlrpc.client.ServerProxy(uri).getPid(rospy.get_name())[2]
        os.kill(pid, signal.SIGINT)
        self.assertTrue(wait_until(lambda: self.robot.commands[-1] == (0.0, 0.0)))

    def moving(self):
        return self.robot.commands and abs(self.robot.commands[-1][0]) > 0.2

    def far_cell(self):
        return "right_c3" if self.robot.x < 4.0 else "left_c2"

    def start_and_fail(self, *parameters):
        command = [
            "rosrun",
            "kr3_navigation",
            "navigation_node",
            "__name:=navigation_bad",
            *parameters,
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=ANSWER, check=False)
        for parameter in parameters:
            rospy.delete_param("/navigation_bad/" + parameter[1:].split(":=")[0])
        self.assertEqual(done.returncode, 1)
        return done.stdout + done.stderr


if __name__ == "__main__":
    rospy.init_node("navigation_node_test")
    rostest.rosrun("kr3_navigation", "navigation_node_test", NavigationNodeTest)
