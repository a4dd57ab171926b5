#!/usr/bin/python3
"""Contract of lockstep: equal bits in two runs, nobody is left behind, the dead are reported and removed."""
import hashlib
import math
import struct
import subprocess
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import Twist
from kr3_msgs.msg import Acknowledgement, LockstepState, Status
from kr3_msgs.srv import RegisterConsumer, UnregisterConsumer
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, LaserScan
from sim_node_test import TIMEOUT, Collector, start_node, wait_until

NAME = "lockstep_contract"  # of this node, as rostest starts it: the simulator counts its velocity commands
PERIOD = 0.1  # s, simulated: of the laser


class Driver:
    """A consumer that steers by the laser and keeps everything that it received."""

    def __init__(self):
        self.scans = Collector("scan", LaserScan)
        self.truth = Collector("ground_truth/pose", Odometry)
        self.images = Collector("camera/image_raw", Image)
        self.infos = Collector("camera/camera_info", CameraInfo)
        self.commands = rospy.Publisher("cmd_vel", Twist, queue_size=100)
        self.acknowledgements = rospy.Publisher(
            "lockstep/acknowledge", Acknowledgement, queue_size=100
        )
        self.num_commands = 0

    def close(self):
        """So that no later driver takes this one's connections for its own."""
        for collector in (self.scans, self.truth, self.images, self.infos):
            collector.subscriber.unregister()
        self.commands.unregister()
        self.acknowledgements.unregister()

    def register(self, timeout=0.0):
        request = RegisterConsumer._request_class(name=NAME)
        request.period, request.timeout = rospy.Duration(PERIOD), rospy.Duration(timeout)
        response = rospy.ServiceProxy("lockstep/register", RegisterConsumer)(request)
        assert response.status.code == Status.OK, response.status.message
        return response.stamp

    def acknowledge(self, stamp):
        self.acknowledgements.publish(NAME, stamp, self.num_commands)

    def wait_for(self, collector, stamp):
        wait_until(
            lambda: collector.messages and collector.messages[-1].header.stamp >= stamp,
            f"{collector.subscriber.name} of {stamp.to_sec():.3f}",
        )
        return collector.messages[-1]

    def run(self, start, num_periods):
        stamp = start
        for _ in range(num_periods):
            scan = self.wait_for(self.scans, stamp)
            self.wait_for(self.truth, stamp)
            command = Twist()
            command.linear.x = 0.4
            near = min(r for r in scan.ranges if math.isfinite(r))
            command.angular.z = 1.0 if near < 0.5 else 0.3 * math.sin(scan.ranges[90])
            self.commands.publish(command)
            self.num_commands += 1
            self.acknowledge(stamp)
            stamp += rospy.Duration(PERIOD)
        self.wait_for(self.truth, stamp)
        return stamp


def run_once(name):
    """The bits of all that a driver saw in a simulation of its own."""
    driver = Driver()
    node = start_node(
        name, real_time_factor=0.0, lockstep_consumers=[NAME], seed=5, camera_rate=2.0
    )
    try:
        for topic in (driver.commands, driver.acknowledgements):
            wait_until(lambda t=topic: t.get_num_connections() > 0, "sim_node listens")
        for collector in (driver.scans, driver.truth, driver.images):
            wait_until(lambda c=collector: c.subscriber.get_num_connections() > 0, "publishers")
        assert not driver.scans.messages, "time must not begin without the consumer"
        start = driver.register(timeout=60.0)  # a busy machine is no dead consumer
        end = driver.run(start, 80)
        time.sleep(0.3)  # more would have come by now if the simulation had not waited
        assert driver.truth.messages[-1].header.stamp == end, "it ran ahead of its consumer"
        driver.wait_for(driver.images, end - rospy.Duration(0.5))
    finally:
        node.send_signal(2)
        output, _ = node.communicate(timeout=TIMEOUT)
        driver.close()
    assert node.returncode == 0, output
    scans = [struct.pack(f"{len(m.ranges)}f", *m.ranges) for m in driver.scans.messages]
    poses = [
        struct.pack(
            "7d2d",
            *(getattr(m.pose.pose.position, k) for k in "xyz"),
            *(getattr(m.pose.pose.orientation, k) for k in "wxyz"),
            m.twist.twist.linear.x,
            m.twist.twist.angular.z,
        )
        for m in driver.truth.messages
    ]
    images = {m.header.stamp: hashlib.sha256(m.data).digest() for m in driver.images.messages}
    infos = {m.header.stamp for m in driver.infos.messages}
    return scans, poses, images, infos


class LockstepTest(unittest.TestCase):
    def test_two_runs_agree_in_every_bit(self):
        first = run_once("sim_node_first")
        second = run_once("sim_node_second")
        self.assertEqual(len(first[1]), 81 * 5)
        self.assertGreaterEqual(len(first[2]), 15)
        self.assertEqual(first[0], second[0], "laser")
        self.assertEqual(first[1], second[1], "trajectory")
        self.assertEqual(first[2], second[2], "camera")
        self.assertLessEqual(set(first[2]), first[3], "every image has its camera_info")

    def test_a_dead_consumer_is_reported_and_removed(self):
        node = start_node("sim_node_dead", real_time_factor=0.0)
        try:
            rospy.wait_for_service("lockstep/register", timeout=TIMEOUT)
            state = Collector("lockstep/state", LockstepState)
            clock = Collector("/clock", Clock)
            for collector in (state, clock):
                self.addCleanup(collector.subscriber.unregister)
            driver = Driver()
            self.addCleanup(driver.close)
            driver.register(timeout=0.5)
            began = time.monotonic()
            wait_until(lambda: state.messages and state.messages[-1].removed, "removal")
            self.assertGreater(time.monotonic() - began, 0.4)
            self.assertEqual(state.messages[-1].removed, [NAME])
            self.assertEqual(state.messages[-1].consumers, [])
            clock.next()  # time goes on
        finally:
            node.send_signal(2)
            output, _ = node.communicate(timeout=TIMEOUT)
        self.assertIn(f"'{NAME}' did not acknowledge", output)

    def test_a_followed_node_that_subscribes_late_misses_no_input(self):
        node = start_node("sim_node_late", real_time_factor=0.0, lockstep_consumers=["late"])
        command = ["rosrun", "kr3_sim_ode", "lockstep_follow", "late", "echo", str(PERIOD)]
        follower = subprocess.Popen([*command, "--timeout", "1000"])
        try:
            rospy.wait_for_service("lockstep/register", timeout=TIMEOUT)
            echo = rospy.Publisher("echo", LaserScan, queue_size=100)
            self.addCleanup(echo.unregister)
            clock = Collector("/clock", Clock)
            self.addCleanup(clock.subscriber.unregister)
            wait_until(lambda: echo.get_num_connections() > 0, "lockstep_follow listens")
            time.sleep(1.0)  # it reads a map, say
            scans = rospy.Subscriber("scan", LaserScan, echo.publish)
            self.addCleanup(scans.unregister)
            wait_until(lambda: clock.messages, "the latched time")
            start = clock.messages[0].clock
            passed = 20 * PERIOD
            wait_until(lambda: (clock.messages[-1].clock - start).to_sec() > passed, "time passes")
        finally:
            for process in (follower, node):
                process.send_signal(2)
                process.wait(timeout=TIMEOUT)

    def test_bad_requests_change_nothing(self):
        node = start_node("sim_node_bad", real_time_factor=0.0)
        try:
            rospy.wait_for_service("lockstep/register", timeout=TIMEOUT)
            register = rospy.ServiceProxy("lockstep/register", RegisterConsumer)
            self.assertEqual(
                register("", rospy.Duration(0), rospy.Duration(0)).status.code,
                Status.INVALID_ARGUMENT,
            )
            self.assertEqual(
                register("x", rospy.Duration(-1), rospy.Duration(0)).status.code,
                Status.INVALID_ARGUMENT,
            )
            gone = rospy.ServiceProxy("lockstep/unregister", UnregisterConsumer)("nobody")
            self.assertEqual(gone.status.code, Status.NOT_FOUND)
            driver = Driver()
            self.addCleanup(driver.close)
            wait_until(lambda: driver.acknowledgements.get_num_connections() > 0, "sim_node")
            driver.acknowledge(rospy.Time(1))  # of nobody
            Collector("/clock", Clock).next()
            self.assertEqual(register("x", rospy.Duration(0), rospy.Duration(0)).status.code, 0)
            gone = rospy.ServiceProxy("lockstep/unregister", UnregisterConsumer)("x")
            self.assertEqual(gone.status.code, Status.OK)
            Collector("/clock", Clock).next()
        finally:
            node.send_signal(2)
            node.communicate(timeout=TIMEOUT)


if __name__ == "__main__":
    rospy.init_node(NAME, disable_rostime=True)
    rostest.rosrun("kr3_sim_ode", "lockstep_contract", "__main__")
