"""A kinematic robot with a laser in two rooms: what the contract tests of navigation_node need of a robot.

It publishes /clock, odom (slightly wrong), scan, ground_truth/pose and /tf_static, and follows cmd_vel.
"""

import math
import threading
import time

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

PERIOD = 0.02  # s, simulated
SPEED_UP = 5.0  # simulated seconds per wall second, at most
BEAMS = 360
COMMAND_TIMEOUT = 0.5  # s
# x_min, y_min, x_max, y_max; a door of 1 m at (4, 2), a table in the left room
BOXES = np.array(
    [
        (-0.1, -0.1, 8.1, 0.0),
        (-0.1, 4.0, 8.1, 4.1),
        (-0.1, -0.1, 0.0, 4.1),
        (8.0, -0.1, 8.1, 4.1),
        (3.95, 0.0, 4.05, 1.5),
        (3.95, 2.5, 4.05, 4.0),
        (0.6, 0.5, 1.8, 1.1),
    ]
)


def cast(x: float, y: float, angles: np.ndarray) -> np.ndarray:
    """Distances to the nearest box, shape [len(angles)]."""
    dx, dy = np.cos(angles)[:, None], np.sin(angles)[:, None]
    dx, dy = np.where(np.abs(dx) < 1e-9, 1e-9, dx), np.where(np.abs(dy) < 1e-9, 1e-9, dy)
    x_a, x_b = (BOXES[:, 0] - x) / dx, (BOXES[:, 2] - x) / dx
    y_a, y_b = (BOXES[:, 1] - y) / dy, (BOXES[:, 3] - y) / dy
    enter = np.maximum(np.minimum(x_a, x_b), np.minimum(y_a, y_b))
    leave = np.minimum(np.maximum(x_a, x_b), np.maximum(y_a, y_b))
    hit = (enter <= leave) & (leave > 0.0)
    return np.where(hit, np.maximum(enter, 0.0), np.inf).min(axis=1)


class FakeRobot:
    """Runs in a thread of its own until the node shuts down."""

    def __init__(self, x: float, y: float, yaw: float) -> None:
        self.x, self.y, self.yaw = x, y, yaw
        self.time = 1.0
        self.commands = []
        self._odom = [0.0, 0.0, 0.0]
        self._command, self._command_time = Twist(), -1.0
        self._noise = np.random.default_rng(1)
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=100)
        self._truth = rospy.Publisher("ground_truth/pose", Odometry, queue_size=100)
        self._scan = rospy.Publisher("scan", LaserScan, queue_size=10)
        self._static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        mount = TransformStamped()
        mount.header.frame_id, mount.child_frame_id = "base_link", "laser"
        mount.transform.translation.z, mount.transform.rotation.w = 0.3, 1.0
        self._static.publish([mount])
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=10)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _on_command(self, message: Twist) -> None:
        self._command, self._command_time = message, self.time
        self.commands.append((message.linear.x, message.angular.z))

    def _run(self) -> None:
        tick = 0
        while not rospy.is_shutdown():
            started = time.monotonic()
            self._step()
            try:
                self._publish(tick)
            except rospy.ROSException:
                return  # the node shuts down
            tick += 1
            # the pace of simulated time, not a wait for something
            time.sleep(max(0.0, PERIOD / SPEED_UP - (time.monotonic() - started)))

    def _step(self) -> None:
        self.time += PERIOD
        alive = self.time - self._command_time < COMMAND_TIMEOUT
        linear = self._command.linear.x if alive else 0.0
        angular = self._command.angular.z if alive else 0.0
        self.x += linear * math.cos(self.yaw) * PERIOD
        self.y += linear * math.sin(self.yaw) * PERIOD
        self.yaw += angular * PERIOD
        self._odom[0] += 1.01 * linear * math.cos(self._odom[2]) * PERIOD
        self._odom[1] += 1.01 * linear * math.sin(self._odom[2]) * PERIOD
        self._odom[2] += 0.99 * angular * PERIOD

    def _publish(self, tick: int) -> None:
        stamp = rospy.Time.from_sec(self.time)
        self._clock.publish(stamp)
        self._odometry.publish(self._pose(stamp, "odom", *self._odom))
        self._truth.publish(self._pose(stamp, "world", self.x, self.y, self.yaw))
        if tick % 5 == 0:
            scan = LaserScan()
            scan.header.stamp, scan.header.frame_id = stamp, "laser"
            scan.angle_increment = 2.0 * math.pi / BEAMS
            scan.angle_max = scan.angle_increment * (BEAMS - 1)
            scan.range_min, scan.range_max = 0.1, 12.0
            angles = self.yaw + scan.angle_increment * np.arange(BEAMS)
            scan.ranges = cast(self.x, self.y, angles) + self._noise.normal(0.0, 0.01, BEAMS)
            self._scan.publish(scan)

    @staticmethod
    def _pose(stamp: rospy.Time, frame: str, x: float, y: float, yaw: float) -> Odometry:
        message = Odometry()
        message.header.stamp, message.header.frame_id = stamp, frame
        message.child_frame_id = "base_link"
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.pose.pose.orientation.z = math.sin(yaw / 2.0)
        message.pose.pose.orientation.w = math.cos(yaw / 2.0)
        return message
