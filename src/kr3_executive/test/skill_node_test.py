#!/usr/bin/python3
"""Contract of skill_node, with hand-written fakes of the robot, the navigator and the detector around it."""
import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

import actionlib
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist
from kr3_msgs.msg import (
    Cell,
    CellArray,
    Detection,
    DetectionArray,
    ExecuteSkillAction,
    ExecuteSkillGoal,
    Status,
)
from kr3_msgs.srv import CloseGripper, CloseGripperResponse, OpenGripper, OpenGripperResponse
from move_base_msgs.msg import MoveBaseAction, MoveBaseResult
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import CameraInfo, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

DEADLINE_S = 40.0
RATE_HZ = 50.0
VIEW_RAD = 1.2
REACH_M = 0.75
HELD = "held"


def quaternion_z(yaw):
    return math.sin(yaw / 2.0), math.cos(yaw / 2.0)


class FakeWorld:
    """A robot that follows cmd_vel exactly in an empty 8 m x 4 m hall of two cells, and one cup. All in `map`."""

    def __init__(self):
        self.lock = threading.RLock()
        self.x, self.y, self.yaw = 2.0, 2.0, 0.0
        self.speed, self.turn = 0.0, 0.0
        self.cup = (3.0, 1.0)  # or HELD, or None
        self.book = None  # a second object, where it stands
        self.reachable = True
        self.frames = 0
        self.tf = tf2_ros.TransformBroadcaster()
        self.odom = rospy.Publisher("odom", Odometry, queue_size=1)
        self.scan = rospy.Publisher("scan", LaserScan, queue_size=1)
        self.detections = rospy.Publisher("detections", DetectionArray, queue_size=1)
        self.info = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=1, latch=True)
        focal = 320.0 / math.tan(VIEW_RAD / 2.0)
        self.info.publish(
            CameraInfo(width=640, height=480, K=[focal, 0, 320, 0, focal, 240, 0, 0, 1])
        )
        self.holding = rospy.Publisher("gripper/holding", Bool, queue_size=1, latch=True)
        self.holding.publish(Bool(False))
        self.cells = rospy.Publisher("cells", CellArray, queue_size=1, latch=True)
        cells = CellArray()
        for name, x in (("hall_west", 2.0), ("hall_east", 6.0)):
            cell = Cell(name=name, room="hall", size_x=4.0, size_y=4.0)
            cell.center.x, cell.center.y = x, 2.0
            cells.cells.append(cell)
        self.cells.publish(cells)
        self.map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        grid = OccupancyGrid(data=[0] * (80 * 40))
        grid.info.resolution, grid.info.width, grid.info.height = 0.1, 80, 40
        self.map.publish(grid)
        rospy.Subscriber("cmd_vel", Twist, self.on_command)
        rospy.Service("gripper/close", CloseGripper, self.on_close)
        rospy.Service("gripper/open", OpenGripper, self.on_open)
        self.driver = actionlib.SimpleActionServer(
            "move_base", MoveBaseAction, self.on_goal, auto_start=False
        )
        self.driver.start()
        self.timer = rospy.Timer(rospy.Duration(1.0 / RATE_HZ), self.step)

    def on_command(self, twist):
        with self.lock:
            self.speed, self.turn = twist.linear.x, twist.angular.z

    def cup_from_robot(self):
        return self.from_robot(self.cup)

    def from_robot(self, point):
        dx, dy = point[0] - self.x, point[1] - self.y
        bearing = math.atan2(dy, dx) - self.yaw
        return math.hypot(dx, dy), math.atan2(math.sin(bearing), math.cos(bearing))

    def on_close(self, _):
        with self.lock:
            if isinstance(self.cup, tuple):
                distance, bearing = self.cup_from_robot()
                if distance < REACH_M and abs(bearing) < 0.6:
                    self.cup = HELD
            self.holding.publish(Bool(self.cup == HELD))
            return CloseGripperResponse(Status(), self.cup == HELD)

    def on_open(self, _):
        with self.lock:
            released = self.cup == HELD
            if released:
                self.cup = (self.x + 0.5 * math.cos(self.yaw), self.y + 0.5 * math.sin(self.yaw))
            self.holding.publish(Bool(False))
            return OpenGripperResponse(Status(), released)

    def on_goal(self, goal):
        with self.lock:
            if not self.reachable:
                self.driver.set_aborted(MoveBaseResult())
                return
            pose = goal.target_pose.pose
            self.x, self.y = pose.position.x, pose.position.y
            self.yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
            self.step(None)
        self.driver.set_succeeded(MoveBaseResult())

    def transform(self, parent, child, x, y, z, rotation):
        message = TransformStamped()
        message.header.stamp, message.header.frame_id, message.child_frame_id = (
            self.now,
            parent,
            child,
        )
        t = message.transform
        t.translation.x, t.translation.y, t.translation.z = x, y, z
        t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w = rotation
        return message

    def step(self, _):
        with self.lock:
            self.now = rospy.Time.now()
            self.yaw += self.turn / RATE_HZ
            self.x += self.speed * math.cos(self.yaw) / RATE_HZ
            self.y += self.speed * math.sin(self.yaw) / RATE_HZ
            sine, cosine = quaternion_z(self.yaw)
            identity, optical = (0, 0, 0, 1), (-0.5, 0.5, -0.5, 0.5)
            self.tf.sendTransform(
                [
                    self.transform("map", "base_link", self.x, self.y, 0.0, (0, 0, sine, cosine)),
                    self.transform("base_link", "laser", 0.0, 0.0, 0.3, identity),
                    self.transform("base_link", "camera_optical_frame", 0.0, 0.0, 0.6, optical),
                ]
            )
            odom = Odometry()
            odom.header.stamp = self.now
            odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
            odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = sine, cosine
            odom.twist.twist.linear.x, odom.twist.twist.angular.z = self.speed, self.turn
            self.odom.publish(odom)
            scan = LaserScan(
                angle_min=-math.pi, angle_max=math.pi, angle_increment=math.pi / 180, range_max=12.0
            )
            scan.header.frame_id, scan.header.stamp = "laser", self.now
            scan.ranges = [math.inf] * 361
            self.scan.publish(scan)
            self.frames += 1
            if self.frames % 5 == 0:
                self.detections.publish(self.picture())

    def picture(self):
        message = DetectionArray()
        message.header.stamp, message.header.frame_id = self.now, "camera_optical_frame"
        for name, point in (("cup", self.cup), ("book", self.book)):
            if not isinstance(point, tuple):
                continue
            distance, bearing = self.from_robot(point)
            if abs(bearing) < VIEW_RAD / 2.0:
                found = Detection(
                    name=name, class_name="thing", probability=0.95, has_position=True
                )
                found.position.x = -distance * math.sin(bearing)
                found.position.y = 0.5  # on the floor: below the laser
                found.position.z = distance * math.cos(bearing)
                message.detections.append(found)
        return message


class SkillNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.world = FakeWorld()
        cls.folder = tempfile.TemporaryDirectory()
        objects = pathlib.Path(cls.folder.name) / "objects.yaml"
        objects.write_text("objects: [{name: cup}, {name: book}]\n", encoding="utf-8")
        cls.objects = str(objects)
        bindings = pathlib.Path(cls.folder.name) / "bindings.yaml"
        bindings.write_text('sightings: {seen: "stands(${object}) = ${cell}"}\n', encoding="utf-8")
        cls.bindings = str(bindings)
        unworded = pathlib.Path(cls.folder.name) / "unworded.yaml"
        unworded.write_text('sightings: {seen: "stands(${object})"}\n', encoding="utf-8")
        cls.unworded = str(unworded)
        rospy.set_param("/skill_node", {"objects": cls.objects, "bindings": cls.bindings})
        cls.node = subprocess.Popen(["rosrun", "kr3_executive", "skill_node"])
        cls.clients = {}
        for skill in ("search", "grasp", "put_down", "hand_over"):
            client = actionlib.SimpleActionClient(f"skills/{skill}", ExecuteSkillAction)
            if not client.wait_for_server(rospy.Duration(DEADLINE_S)):
                raise RuntimeError(f"no server of {skill}")
            cls.clients[skill] = client

    @classmethod
    def tearDownClass(cls):
        cls.node.send_signal(signal.SIGINT)
        code = cls.node.wait(DEADLINE_S)
        cls.folder.cleanup()
        if code != 0:
            raise RuntimeError(f"skill_node ended with {code}")

    def setUp(self):
        with self.world.lock:
            self.world.x, self.world.y, self.world.yaw = 2.0, 2.0, 0.0
            self.world.speed = self.world.turn = 0.0
            self.world.cup = (3.0, 1.0)
            self.world.book = None
            self.world.reachable = True
            self.world.holding.publish(Bool(False))
            self.world.step(None)
        # A skill that starts before the robot's new pose has arrived looks round from the old one.
        threading.Event().wait(0.3)

    def run_skill(self, skill, arguments, time_limit=0.0):
        client = self.clients[skill]
        client.send_goal(
            ExecuteSkillGoal(
                skill=skill, arguments=arguments, time_limit=rospy.Duration.from_sec(time_limit)
            )
        )
        self.assertTrue(client.wait_for_result(rospy.Duration(DEADLINE_S)), f"{skill} does not end")
        return client.get_result()

    def assert_ok(self, result, outcome):
        self.assertEqual((result.status.code, result.outcome), (Status.OK, outcome), f"{result}")

    def test_search_finds_behind_the_robot(self):
        self.world.cup = (1.0, 2.2)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "found")
        self.assertEqual(result.observation, ["hall_west"])
        self.assertAlmostEqual(result.confidence, 0.95, places=5)
        self.assertGreater(result.duration_s, 0.0)

    def test_search_says_where_else_or_nothing(self):
        self.world.cup = (5.0, 2.0)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "not_found")
        self.assertEqual(result.observation, ["hall_east"])
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        self.assertEqual(result.observation, [])

    def test_search_tells_what_it_sees_by_the_way(self):
        self.world.book = (6.5, 2.2)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "found")
        told = {sighting.literal: sighting.confidence for sighting in result.sightings}
        self.assertLessEqual(set(told), {"stands(book) = hall_east"})
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        told = {sighting.literal: sighting.confidence for sighting in result.sightings}
        self.assertEqual(told.pop("stands(book) = hall_east", None), 0.95)
        self.assertLessEqual(set(told), {"stands(cup) = hall_west"})
        self.world.book = None
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        self.assertEqual([s.literal for s in result.sightings], ["stands(cup) = hall_west"])

    def test_grasps_and_puts_down(self):
        self.assert_ok(self.run_skill("search", ["hall_west", "cup"]), "found")
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "succeeded")
        self.assertEqual(self.world.cup, HELD)
        self.assertEqual(self.world.speed, 0.0)
        again = self.run_skill("grasp", ["cup", "hall_west"])
        self.assertEqual(again.status.code, Status.FAILED_PRECONDITION)
        self.assert_ok(self.run_skill("put_down", ["cup"]), "succeeded")
        self.assertIsInstance(self.world.cup, tuple)

    def test_grasp_fails_where_it_cannot_get_or_see(self):
        self.world.reachable = False
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "failed")
        self.world.reachable = True
        self.world.cup = None
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "failed")

    def test_hand_over_waits_for_a_person(self):
        requests = []
        rospy.Subscriber("hand_over/request", String, lambda m: requests.append(m.data))
        self.assert_ok(self.run_skill("hand_over", ["cup"], time_limit=1.0), "failed")
        self.world.cup = (2.5, 2.0)
        client = self.clients["hand_over"]
        requests.clear()
        client.send_goal(ExecuteSkillGoal(skill="hand_over", arguments=["cup"]))
        event = threading.Event()
        for _ in range(int(DEADLINE_S / 0.05)):
            if any("cup" in request for request in requests):
                break
            event.wait(0.05)
        rospy.wait_for_service("hand_over/confirm", DEADLINE_S)
        self.assertTrue(rospy.ServiceProxy("hand_over/confirm", Trigger)().success)
        self.assertTrue(client.wait_for_result(rospy.Duration(DEADLINE_S)))
        self.assert_ok(client.get_result(), "succeeded")

    def test_rejects_bad_requests_and_survives(self):
        for skill, arguments, code in (
            ("search", ["attic", "cup"], Status.INVALID_ARGUMENT),
            ("search", ["hall_west", "unicorn"], Status.INVALID_ARGUMENT),
            ("search", ["hall_west"], Status.INVALID_ARGUMENT),
            ("search", ["hall_east", "cup"], Status.FAILED_PRECONDITION),
            ("grasp", ["unicorn"], Status.INVALID_ARGUMENT),
            ("grasp", ["cup", "attic"], Status.INVALID_ARGUMENT),
            ("put_down", ["cup"], Status.FAILED_PRECONDITION),
            ("hand_over", [], Status.INVALID_ARGUMENT),
        ):
            result = self.run_skill(skill, arguments)
            self.assertEqual(
                result.status.code, code, f"{skill} {arguments}: {result.status.message}"
            )
            self.assertNotEqual(result.status.message, "")
        self.assert_ok(self.run_skill("search", ["hall_west", "cup"]), "found")

    def test_cancel_and_time_limit_stop_the_wheels(self):
        self.world.cup = None
        client = self.clients["search"]
        client.send_goal(ExecuteSkillGoal(skill="search", arguments=["hall_west", "cup"]))
        event = threading.Event()
        for _ in range(int(DEADLINE_S / 0.02)):
            if self.world.turn != 0.0:
                break
            event.wait(0.02)
        client.cancel_goal()
        self.assertTrue(client.wait_for_result(rospy.Duration(DEADLINE_S)))
        self.assertEqual(client.get_result().status.code, Status.CANCELLED)
        result = self.run_skill("search", ["hall_west", "cup"], time_limit=1.0)
        self.assertEqual(result.status.code, Status.DEADLINE_EXCEEDED)
        for _ in range(100):
            if self.world.turn == 0.0 and self.world.speed == 0.0:
                return
            event.wait(0.02)
        self.fail("the wheels still turn")

    def test_refuses_bad_parameters(self):
        for params, word in (
            ({}, "objects"),
            ({"objects": "/nowhere.yaml"}, "/nowhere.yaml"),
            ({"objects": self.objects, "bindings": "/nowhere.yaml"}, "bindings file"),
            ({"objects": self.objects, "bindings": self.unworded}, "without ${cell}"),
            ({"objects": self.objects, "turn_sped": 1.0}, "turn_sped"),
            ({"objects": self.objects, "creep_speed": -1.0}, "creep_speed"),
        ):
            rospy.set_param("/other_skills", params)
            result = subprocess.run(
                ["rosrun", "kr3_executive", "skill_node", "__name:=other_skills"],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=DEADLINE_S,
                text=True,
            )
            rospy.delete_param("/other_skills")
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(word, result.stdout)


if __name__ == "__main__":
    rospy.init_node("skill_node_contract")
    rostest.rosrun("kr3_executive", "skill_node", SkillNodeTest, sys.argv)
