#!/usr/bin/python3
"""Contract of sim_node: it starts, answers, refuses bad input with a Status, survives it, and stops."""
import math
import pathlib
import subprocess
import sys
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import Twist
from kr3_msgs.msg import ModelStates, SimulationState, Status
from kr3_msgs.srv import (
    CloseGripper,
    DeleteModel,
    OpenGripper,
    SetModelPose,
    SpawnModel,
    StepSimulation,
)
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, LaserScan
from std_msgs.msg import Bool, UInt8MultiArray
from std_srvs.srv import Trigger

DATA = pathlib.Path(__file__).resolve().parent / "data"
CONFIG = pathlib.Path(__file__).resolve().parent.parent / "config" / "sim_node.yaml"
TIMEOUT = 20.0  # s of wall time, for anything


def start_node(name: str, **parameters) -> subprocess.Popen:
    """Start a sim_node with its default configuration and the test building, as a user does."""
    subprocess.run(["rosparam", "load", str(CONFIG), f"/{name}"], check=True)
    rospy.set_param(f"/{name}/building", str(DATA / "two_rooms.yaml"))
    rospy.set_param(f"/{name}/objects", str(DATA / "objects.yaml"))
    rospy.set_param(f"/{name}/camera_width", 160)
    rospy.set_param(f"/{name}/camera_height", 120)
    for key, value in parameters.items():
        rospy.set_param(f"/{name}/{key}", value)
    command = ["rosrun", "kr3_sim_ode", "sim_node", f"__name:={name}"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def wait_until(condition, what: str) -> None:
    deadline = time.monotonic() + TIMEOUT
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"timeout: {what}")
        time.sleep(0.005)


class Collector:
    """Keeps the messages of a topic."""

    def __init__(self, topic, message_type):
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, message_type, self.messages.append)

    def next(self):
        """The next message that arrives from now on."""
        count = len(self.messages)
        wait_until(lambda: len(self.messages) > count, self.subscriber.name)
        return self.messages[-1]


class SimNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.node = start_node("sim_node", real_time_factor=5.0, grasp_failure_rate=0.0)
        cls.clock = Collector("/clock", Clock)
        cls.models = Collector("ground_truth/models", ModelStates)
        cls.pose = Collector("ground_truth/pose", Odometry)
        cls.state = Collector("simulation/state", SimulationState)
        for service in ("gripper/close", "simulation/set_model_pose", "simulation/reset"):
            rospy.wait_for_service(service, timeout=TIMEOUT)

    @classmethod
    def tearDownClass(cls):
        cls.node.send_signal(2)
        output, _ = cls.node.communicate(timeout=TIMEOUT)
        assert cls.node.returncode == 0, output

    def call(self, name, service_type, *args):
        return rospy.ServiceProxy(name, service_type)(*args)

    def set_pose(self, name, x, y, z, yaw=0.0):
        request = SetModelPose._request_class(name=name)
        request.pose.position.x, request.pose.position.y, request.pose.position.z = x, y, z
        request.pose.orientation.z, request.pose.orientation.w = math.sin(yaw / 2), math.cos(
            yaw / 2
        )
        return self.call("simulation/set_model_pose", SetModelPose, request)

    def drive(self, command, duration):
        """Send a command at 20 Hz of simulated time, from another thread's point of view."""
        publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        wait_until(lambda: publisher.get_num_connections() > 0, "a subscriber of cmd_vel")
        end = self.clock.next().clock.to_sec() + duration
        while self.clock.next().clock.to_sec() < end:
            publisher.publish(command)
        publisher.unregister()

    def test_publishes_what_the_conventions_say(self):
        self.assertEqual(
            rospy.wait_for_message("scan", LaserScan, TIMEOUT).header.frame_id, "laser"
        )
        odometry = rospy.wait_for_message("odom", Odometry, TIMEOUT)
        self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), ("odom", "base_link"))
        info = rospy.wait_for_message("camera/camera_info", CameraInfo, TIMEOUT)
        image = rospy.wait_for_message("camera/image_raw", Image, TIMEOUT)
        self.assertEqual((image.width, image.height), (info.width, info.height))
        self.assertEqual(image.encoding, "bgr8")
        self.assertEqual(image.header.frame_id, "camera_optical_frame")
        self.assertEqual(len(image.data), image.step * image.height)
        self.assertGreater(max(image.data), 100)
        self.assertFalse(rospy.wait_for_message("gripper/holding", Bool, TIMEOUT).data)
        self.assertEqual([m.name for m in self.models.messages[-1].models], ["book", "cup"])
        self.assertGreater(self.state.next().real_time_factor, 0.0)

    def test_tells_the_world_as_an_octomap_and_again_after_changes(self):
        octomap = Collector("ground_truth/octomap_binary", UInt8MultiArray)
        before = bytes(octomap.next().data)
        self.assertTrue(before.startswith(b"# Octomap OcTree binary file"))
        self.set_pose("cup", 6.0, 1.0, 0.06)
        self.assertNotEqual(bytes(octomap.next().data), before)

    def test_drives_and_stops_without_commands(self):
        self.set_pose("robot", 1.0, 2.0, 0.0)
        command = Twist()
        command.linear.x = 0.3
        self.drive(command, 1.5)
        self.assertGreater(self.pose.next().pose.pose.position.x, 1.2)
        stop_after = self.clock.next().clock.to_sec() + 1.5  # timeout, then braking
        wait_until(lambda: self.clock.messages[-1].clock.to_sec() > stop_after, "clock")
        self.assertAlmostEqual(self.pose.next().twist.twist.linear.x, 0.0, delta=0.01)

    def test_ignores_commands_that_are_no_numbers(self):
        self.set_pose("robot", 1.0, 2.0, 0.0)
        for linear, angular in (
            (math.nan, 0.0),
            (math.inf, 0.0),
            (0.2, math.nan),
            (0.2, -math.inf),
        ):
            command = Twist()
            command.linear.x, command.angular.z = linear, angular
            self.drive(command, 0.3)
            pose = self.pose.next().pose.pose
            self.assertAlmostEqual(pose.position.x, 1.0, delta=0.05)
            self.assertAlmostEqual(pose.orientation.z, 0.0, delta=0.02)

    def test_grasps_carries_and_puts_down(self):
        self.call("simulation/reset", Trigger)
        self.set_pose("book", 2.0, 0.45, 0.545)
        self.set_pose("robot", 2.0, 2.0, 0.0)
        self.assertFalse(self.call("gripper/close", CloseGripper).holding)
        self.set_pose("robot", 2.0, 1.1, 0.0, -math.pi / 2)
        reply = self.call("gripper/close", CloseGripper)
        self.assertTrue(reply.holding)
        wait_until(
            lambda: self.models.messages[-1].held == "book", "ground truth tells what is held"
        )
        self.assertTrue(rospy.wait_for_message("gripper/holding", Bool, TIMEOUT).data)
        again = self.call("gripper/close", CloseGripper)
        self.assertEqual(again.status.code, Status.FAILED_PRECONDITION)
        self.assertTrue(self.call("gripper/open", OpenGripper).released)
        wait_until(
            lambda: self.models.messages[-1].held == "", "ground truth tells that nothing is held"
        )

    def test_pauses_steps_and_resumes(self):
        refused = self.call("simulation/step", StepSimulation, 10)
        self.assertEqual(refused.status.code, Status.FAILED_PRECONDITION)
        self.call("simulation/pause", Trigger)
        first = self.call("simulation/step", StepSimulation, 10)
        second = self.call("simulation/step", StepSimulation, 25)
        self.assertAlmostEqual((second.now - first.now).to_sec(), 25 * 0.002, places=9)
        none = self.call("simulation/step", StepSimulation, 0)
        self.assertEqual(none.status.code, Status.INVALID_ARGUMENT)
        self.call("simulation/resume", Trigger)
        self.assertGreater(self.clock.next().clock, second.now)

    def test_who_comes_while_time_stands_hears_the_time(self):
        self.call("simulation/pause", Trigger)
        now = self.call("simulation/step", StepSimulation, 5).now
        program = (
            "import rospy; from rosgraph_msgs.msg import Clock; rospy.init_node('late', anonymous=True);"
            "print(rospy.wait_for_message('/clock', Clock).clock.to_nsec())"
        )
        late = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True
        )
        self.call("simulation/resume", Trigger)
        heard = rospy.Time(nsecs=int(late.stdout)) if late.stdout else None
        self.assertIsNotNone(heard, late.stderr)
        self.assertLess(abs((now - heard).to_sec()), 0.011)  # the clock has a period of 0.01 s

    def test_the_clock_never_runs_backwards(self):
        self.call("simulation/reset", Trigger)
        self.clock.next()
        stamps = [m.clock for m in self.clock.messages]
        self.assertEqual(stamps, sorted(stamps))
        self.assertGreaterEqual(min(b - a for a, b in zip(stamps, stamps[1:])).to_sec(), 0.0099)

    def test_a_reset_gives_the_same_world_again(self):
        self.call("simulation/pause", Trigger)
        self.call("simulation/reset", Trigger)
        before = self.models.messages[-1]
        self.set_pose("cup", 5.0, 1.0, 0.06)
        self.call("simulation/reset", Trigger)
        wait_until(
            lambda: self.models.messages[-1].models == before.models, "objects back in place"
        )
        self.call("simulation/resume", Trigger)

    def test_spawns_and_deletes(self):
        request = SpawnModel._request_class(name="crate1", model="crate")
        request.pose.position.x, request.pose.position.y, request.pose.position.z = 6.0, 1.0, 0.2
        request.pose.orientation.w = 1.0
        self.assertEqual(
            self.call("simulation/spawn_model", SpawnModel, request).status.code, Status.OK
        )
        taken = self.call("simulation/spawn_model", SpawnModel, request)
        self.assertEqual(taken.status.code, Status.INVALID_ARGUMENT)
        request.name, request.model = "sofa1", "sofa"
        unknown = self.call("simulation/spawn_model", SpawnModel, request)
        self.assertEqual(unknown.status.code, Status.NOT_FOUND)
        self.assertIn("crate", unknown.status.message)
        self.assertEqual(
            self.call("simulation/delete_model", DeleteModel, "crate1").status.code, Status.OK
        )
        gone = self.call("simulation/delete_model", DeleteModel, "crate1")
        self.assertEqual(gone.status.code, Status.NOT_FOUND)
        self.assertEqual(self.set_pose("nothing", 1.0, 1.0, 1.0).status.code, Status.NOT_FOUND)
        bad = self.set_pose("book", float("nan"), 1.0, 1.0)
        self.assertEqual(bad.status.code, Status.INVALID_ARGUMENT)


class BadStartTest(unittest.TestCase):
    def expect_refusal(self, name, *messages, **parameters):
        node = start_node(name, **parameters)
        output, _ = node.communicate(timeout=TIMEOUT)
        self.assertEqual(node.returncode, 1, output)
        for message in messages:
            self.assertIn(message, output)

    def test_refuses_an_unknown_place_in_placements(self):
        self.expect_refusal(
            "bad_place", "unknown place 'attic'", "left, right", placements=["book=attic"]
        )

    def test_refuses_an_unknown_object_in_placements(self):
        self.expect_refusal("bad_object", "unknown object 'sofa'", "book", placements=["sofa=left"])

    def test_refuses_a_missing_building(self):
        self.expect_refusal("bad_file", "/nowhere.yaml", building="/nowhere.yaml")

    def test_refuses_all_bad_parameters_at_once(self):
        self.expect_refusal("bad_parameters", "camera_rate", "sped", camera_rate=-1.0, sped=2)


if __name__ == "__main__":
    rospy.init_node("sim_node_test", disable_rostime=True)
    rostest.rosrun("kr3_sim_ode", "sim_node_contract", "__main__")
