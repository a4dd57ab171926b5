#!/usr/bin/python3
"""A mission outlives its node: executive_node is killed at drawn moments and started again, and the mission ends as it
would have. Missions one after the other keep history, files and time per step bounded.

KR3_LONG_GOALS=N: so many goals one after the other (about 7 high-level steps each); a line is printed for every tenth.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import actionlib
import rosnode
import rospy
import rostest
from executive_node_test import GOAL, ScriptedRobot, start_node, stop_node
from kr3_msgs.msg import AchieveAction, AchieveGoal, MissionEvent, MissionState
from visualization_msgs.msg import MarkerArray

SEED = 20140
KILLS = 5


class SlowRobot(ScriptedRobot):
    """One whose actions take a while, so that a kill may fall into one."""

    pause_s = 0.1

    def _execute(self, server, work, goal):
        time.sleep(self.pause_s)
        super()._execute(server, work, goal)


def memory_kb(pid):
    """Resident memory of a process and of those that it started."""
    listed = subprocess.run(
        ["ps", "-o", "rss=", "-g", str(pid)], stdout=subprocess.PIPE, text=True, check=False
    )
    return sum(int(line) for line in listed.stdout.split())


class ExecutiveResumeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.robot = SlowRobot()
        cls.events = []
        rospy.Subscriber("executive/events", MissionEvent, cls.events.append, queue_size=1000)
        cls.client = actionlib.SimpleActionClient("executive/achieve", AchieveAction)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        with self.robot.lock:
            self.robot.robot, self.robot.book, self.robot.held = (
                "office_c1",
                "aux_library_c0",
                False,
            )
        self.state_file = os.path.join(self.folder.name, self.id() + ".json")
        self.node = None

    def tearDown(self):
        if self.node is not None:
            stop_node(self.node)

    def start(self, **overrides):
        self.node = start_node(state_file=self.state_file, max_backups=300, **overrides)
        threading.Thread(target=self._drain, args=(self.node,), daemon=True).start()
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60)), "no executive_node")

    @staticmethod
    def _drain(process):
        for line in process.stdout:
            print(line, end="")

    def wait_for(self, condition, what, timeout_s=90.0):
        deadline = time.monotonic() + timeout_s
        while not condition():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.01)

    def saved(self):
        with open(self.state_file, encoding="utf-8") as file:
            return json.load(file)

    def test_0_a_node_without_time_obeys_sigint(self):
        rospy.set_param("use_sim_time", True)  # and nobody publishes /clock
        try:
            self.node = start_node()
            waiting = threading.Thread(target=self._drain, args=(self.node,), daemon=True)
            waiting.start()
            self.wait_for(
                lambda: rosnode.get_node_names("/executive_node"), "the node did not start"
            )
            time.sleep(1.0)
            os.killpg(self.node.pid, signal.SIGINT)
            self.assertEqual(0, self.node.wait(timeout=5))
        finally:
            rospy.delete_param("use_sim_time")

    def test_1_killed_at_any_moment_the_mission_ends_the_same(self):
        moments = random.Random(SEED)
        self.start()
        del self.events[:]
        self.client.send_goal(AchieveGoal(goal=GOAL))
        self.wait_for(lambda: self.events, "the mission did not begin")
        kills = 0
        while kills < KILLS and not self.is_done():
            time.sleep(moments.uniform(0.0, 0.8))  # the moment is what is drawn
            if self.is_done():
                break
            os.killpg(self.node.pid, signal.SIGKILL)
            self.node.wait(timeout=30)
            kills += 1
            self.assertIn("mission", self.saved(), f"kill {kills}: the mission was lost")
            del self.events[:]
            self.start()
            self.wait_for(lambda: self.events, "the mission did not go on")
        self.wait_for(self.is_done, "the mission did not end")
        self.assertGreater(kills, 1)
        self.assertTrue(self.robot.book.startswith("study_corner"))
        self.assertFalse(self.robot.held)
        state = rospy.wait_for_message("executive/state", MissionState, timeout=10)
        self.assertEqual(state.state, MissionState.SUCCEEDED)
        refuted = [
            r for r in state.history if r.statement == "loc(tb1) = main_library" and not r.value
        ]
        self.assertEqual(len(refuted), 1, "it was looked for there once")
        self.wait_for(lambda: "mission" not in self.saved(), "the mission is still kept")

    def is_done(self):
        return MissionEvent.DONE in [event.kind for event in self.events]

    def test_2_goals_one_after_the_other_keep_everything_bounded(self):
        number = int(os.environ.get("KR3_LONG_GOALS", "5"))
        long = number > 20
        SlowRobot.pause_s = 0.0
        self.start(**({} if long else {"history_window": 10}))
        self.robot.book = "main_library_c0"
        sizes, steps = [], []
        total = 0
        for index in range(number):
            place = ("kitchen", "office")[index % 2]
            start = time.monotonic()
            self.client.send_goal(
                AchieveGoal(goal=f"loc(tb1) = {place} and not in_hand(rob1, tb1)")
            )
            self.assertTrue(self.client.wait_for_result(rospy.Duration(120)), "no result")
            result = self.client.get_result()
            self.assertTrue(result.achieved, result.reason)
            self.assertTrue(self.robot.book.startswith(place))
            state = rospy.wait_for_message("executive/state", MissionState, timeout=10)
            total += result.hl_actions
            sizes.append(os.path.getsize(self.state_file))
            steps.append(state.hl_step)
            if long and index % 10 == 9:
                print(
                    f"goal {index + 1}: {total} high-level actions, step {state.hl_step},"
                    f" {len(state.history)} records, {sizes[-1]} bytes on disk,"
                    f" {memory_kb(self.node.pid)} kB,"
                    f" {1000.0 * (time.monotonic() - start) / max(result.hl_actions, 1):.0f} ms an action",
                    flush=True,
                )
        window = 60 if long else 10
        longest_mission = 12
        self.assertLessEqual(max(steps), window * 3 // 2 + longest_mission)
        if total > 2 * window:
            self.assertGreater(total, max(steps), "nothing was summed up")

    def test_3_belief_and_plan_are_shown(self):
        shown = {"belief": [], "plan": []}
        subscribers = [
            rospy.Subscriber(
                f"executive/{kind}_markers", MarkerArray, messages.append, queue_size=100
            )
            for kind, messages in shown.items()
        ]
        self.start()
        self.client.send_goal(AchieveGoal(goal=GOAL))
        self.assertTrue(self.client.wait_for_result(rospy.Duration(120)), "no result")
        for subscriber in subscribers:
            subscriber.unregister()
        for kind, messages in shown.items():
            self.assertTrue(messages, f"no {kind} markers")
            for message in messages:
                self.assertEqual(message.markers[0].action, message.markers[0].DELETEALL)
        texts = [marker.text for message in shown["belief"] for marker in message.markers]
        self.assertTrue(
            any(text.startswith("loc(tb1)") and text.endswith("%") for text in texts), texts
        )
        texts = [marker.text for message in shown["plan"] for marker in message.markers]
        self.assertTrue(any("move(rob1, study_corner)" in text for text in texts), texts)
        self.assertEqual(
            len(shown["plan"][-1].markers), 1, "nothing is left of the plan at the end"
        )


if __name__ == "__main__":
    rospy.init_node("executive_resume_test")
    rostest.rosrun("kr3_executive", "executive_resume", ExecutiveResumeTest, sys.argv)
