#!/usr/bin/python3
"""skill_node under a clock that goes back, as when a simulator is started anew in the middle of a skill."""
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import actionlib
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from kr3_msgs.msg import ExecuteSkillAction, ExecuteSkillGoal, Status
from rosgraph_msgs.msg import Clock

DEADLINE_S = 40.0  # wall time
TICK_S = 0.02
LIMIT_S = 4.0  # simulated, of the skill


class GoingClock:
    """Publishes /clock in a thread of its own, as fast as wall time."""

    def __init__(self, start_s):
        self.time_s = start_s
        self._publisher = rospy.Publisher("/clock", Clock, queue_size=10)
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._ends.wait(TICK_S):
            self.time_s += TICK_S
            self._publisher.publish(Clock(rospy.Time.from_sec(self.time_s)))

    def end(self):
        self._ends.set()
        self._thread.join()


class SkillNodeClockTest(unittest.TestCase):
    def setUp(self):
        self.clock = GoingClock(1000.0)
        while rospy.get_time() < 1000.0:  # else the first message is a jump of all waits
            time.sleep(TICK_S)
        self.folder = tempfile.TemporaryDirectory()
        objects = pathlib.Path(self.folder.name) / "objects.yaml"
        objects.write_text("objects: [{name: cup}]\n", encoding="utf-8")
        rospy.set_param("/skill_node", {"objects": str(objects)})
        self.node = subprocess.Popen(["rosrun", "kr3_executive", "skill_node"])

    def tearDown(self):
        self.node.send_signal(signal.SIGINT)
        code = self.node.wait(DEADLINE_S)
        self.clock.end()
        self.folder.cleanup()
        self.assertEqual(code, 0)

    @staticmethod
    def wait_until(condition):
        """In wall time, at most for the deadline."""
        end = time.monotonic() + DEADLINE_S
        while not condition() and time.monotonic() < end:
            time.sleep(TICK_S)

    def test_a_time_limit_holds_when_the_clock_goes_back(self):
        client = actionlib.SimpleActionClient("skills/hand_over", ExecuteSkillAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(DEADLINE_S)))
        limit = rospy.Duration.from_sec(LIMIT_S)
        client.send_goal(ExecuteSkillGoal(skill="hand_over", arguments=["cup"], time_limit=limit))
        self.wait_until(lambda: client.get_state() == GoalStatus.ACTIVE)
        time.sleep(1.0)
        self.clock.time_s = 1.0
        self.wait_until(lambda: client.get_result() is not None)
        result = client.get_result()
        self.assertIsNotNone(result, "the skill waits until the clock has caught up")
        self.assertEqual((result.status.code, result.outcome), (Status.OK, "failed"), f"{result}")
        self.assertGreater(result.duration_s, 0.9 * LIMIT_S)
        self.assertLess(result.duration_s, 10.0 * LIMIT_S)


if __name__ == "__main__":
    rospy.init_node("skill_node_clock_test")
    rostest.rosrun("kr3_executive", "skill_node_clock", SkillNodeClockTest, sys.argv)
