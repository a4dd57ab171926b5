#!/usr/bin/python3
"""Both drivers decide alike: what executive_node decides on its inputs, with reasoner and policy server as nodes, is
decided again in process (kr3_replay), to the last digit. KR3_REFERENCE_BAG=FILE: the first mission is kept there."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import actionlib
import rosbag
import rospy
import rostest
from executive_node_test import GOAL, ScriptedRobot, start_node, stop_node
from kr3_msgs.msg import AchieveAction, AchieveGoal, MissionEvent, MissionInput, Status
from kr3_msgs.srv import Tell

KINDS = ("DOMAIN", "MISSION", "SKILL_RESULT", "TOLD", "CANCEL", "DECISION")


class Peer:
    """A node of another package that is restarted under way."""

    def __init__(self, package, name):
        self.command = ["rosrun", package, name, f"__name:={name}"]
        self.process = subprocess.Popen(self.command, start_new_session=True)

    def restart(self):
        self.stop()
        self.process = subprocess.Popen(self.command, start_new_session=True)

    def stop(self):
        os.killpg(self.process.pid, signal.SIGINT)
        self.process.wait(timeout=30)


class ReplayOfTheNode(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.robot = ScriptedRobot()
        cls.peers = [Peer("kr3_reasoner", "reasoner_node"), Peer("kr3_pomdp", "policy_node")]
        cls.inputs = []
        cls.events = []
        rospy.Subscriber("executive/inputs", MissionInput, cls.inputs.append, queue_size=10000)
        rospy.Subscriber("executive/events", MissionEvent, cls.events.append, queue_size=10000)
        cls.client = actionlib.SimpleActionClient("executive/achieve", AchieveAction)

    @classmethod
    def tearDownClass(cls):
        for peer in cls.peers:
            peer.stop()
        cls.folder.cleanup()

    def setUp(self):
        del self.inputs[:]
        del self.events[:]
        self.robot.searching.clear()
        self.robot.hold_search.set()
        self.place("office_c1", "main_library_c1")
        self.node = start_node(max_backups=300)
        threading.Thread(target=self.node.stdout.read, daemon=True).start()
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60)), "no executive_node")

    def tearDown(self):
        self.robot.hold_search.set()
        self.assertEqual(stop_node(self.node), 0)

    def place(self, robot, book):
        """Where both really are; and that the book is not held."""
        with self.robot.lock:
            self.robot.robot, self.robot.book, self.robot.held = robot, book, False

    def finish(self):
        """The mission's result, once its last decision has arrived."""
        self.assertTrue(self.client.wait_for_result(rospy.Duration(120)), "no result")
        deadline = time.monotonic() + 10.0
        while time.monotonic() < deadline:
            if self.inputs and json.loads(self.inputs[-1].data).get("kind") == "finish":
                break
            time.sleep(0.02)
        return self.client.get_result()

    def achieve(self, goal=GOAL):
        self.client.send_goal(AchieveGoal(goal=goal))
        return self.finish()

    def achieve_as_far_as_a_search(self, **more):
        """Starts a mission whose first search waits."""
        self.robot.hold_search.clear()
        self.client.send_goal(AchieveGoal(goal=GOAL, **more))
        self.assertTrue(self.robot.searching.wait(60), "no search started")
        self.robot.searching.clear()

    def replay(self, *options):
        """Exit code and output of kr3_replay on the inputs that were received."""
        path = os.path.join(self.folder.name, "inputs.jsonl")
        with open(path, "w", encoding="utf-8") as file:
            for message in self.inputs:
                line = {
                    "sequence": message.sequence,
                    "kind": KINDS[message.kind],
                    "stamp_s": message.header.stamp.to_sec(),
                    "data": json.loads(message.data),
                }
                file.write(json.dumps(line) + "\n")
        done = subprocess.run(
            ["rosrun", "kr3_executive", "kr3_replay", path, *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout

    def expect_same(self):
        self.assertEqual([m.sequence for m in self.inputs], list(range(len(self.inputs))))
        code, output = self.replay()
        self.assertEqual(code, 0, output)
        self.assertIn("all the same", output)
        self.assertNotIn("does not reach the mission's end", output)

    def keep(self, file):
        """Writes inputs and events into a bag."""
        taken = [("executive/inputs", message) for message in self.inputs]
        taken += [("executive/events", message) for message in self.events]
        with rosbag.Bag(file, "w", compression=rosbag.Compression.BZ2) as bag:
            for topic, message in sorted(taken, key=lambda item: item[1].header.stamp):
                bag.write(topic, message, message.header.stamp)

    def test_1_a_mission_with_a_surprise(self):
        self.place("office_c1", "aux_library_c0")
        result = self.achieve()
        self.assertTrue(result.achieved, result.reason)
        self.expect_same()
        if "KR3_REFERENCE_BAG" in os.environ:
            self.keep(os.environ["KR3_REFERENCE_BAG"])
        seen = [
            m for m in self.inputs if '"observation":["true"]' in m.data and "search(" in m.data
        ]
        code, output = self.replay("--set", f"{seen[0].sequence}.observation=false", "--check")
        self.assertEqual(code, 1, output)
        self.assertIn("another choice at input", output)
        self.assertIn("nothing is recorded of", output)

    def test_2_the_next_mission_starts_from_what_is_known(self):
        self.assertTrue(self.achieve().achieved)
        del self.inputs[:]
        self.assertTrue(self.achieve("loc(tb1) = kitchen").achieved)
        self.assertTrue(json.loads(self.inputs[1].data)["history"])
        self.expect_same()

    def test_3_reasoner_and_policy_server_are_restarted_under_way(self):
        self.achieve_as_far_as_a_search()
        for peer in self.peers:
            peer.restart()
        self.robot.hold_search.set()
        result = self.finish()
        self.assertTrue(result.achieved, result.reason)
        policies = [m for m in self.inputs if '"kind":"policy"' in m.data]
        requests = [m for m in self.inputs if '"kind":"request_policy"' in m.data]
        self.assertGreater(len(policies), len(requests), "no policy was lost")
        self.expect_same()

    def test_4_a_person_tells_and_cancels(self):
        self.achieve_as_far_as_a_search()
        tell = rospy.ServiceProxy("executive/tell", Tell)
        self.assertEqual(tell("loc(tb1) = kitchen", True, 0.9).status.code, Status.OK)
        self.robot.hold_search.set()  # this search ends, and the fact is taken in
        deadline = time.monotonic() + 60.0
        while MissionInput.TOLD not in [m.kind for m in self.inputs]:
            self.assertLess(time.monotonic(), deadline, "the fact was not taken in")
            time.sleep(0.005)
        self.client.cancel_goal()
        self.assertEqual(self.finish().status.code, Status.CANCELLED)
        self.assertIn(MissionInput.CANCEL, [m.kind for m in self.inputs])
        self.expect_same()

    def test_5_time_runs_out(self):
        self.achieve_as_far_as_a_search(time_limit=rospy.Duration(1.0))
        time.sleep(1.0)  # the mission's time, not a condition to wait for
        self.robot.hold_search.set()
        self.assertEqual(self.finish().status.code, Status.DEADLINE_EXCEEDED)
        self.expect_same()


if __name__ == "__main__":
    rospy.init_node("replay_node_test")
    rostest.rosrun("kr3_executive", "replay_of_the_node", ReplayOfTheNode, sys.argv)
