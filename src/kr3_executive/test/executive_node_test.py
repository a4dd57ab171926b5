#!/usr/bin/python3
"""Contract of executive_node, with the real reasoner and policy server and a scripted robot.

The robot is a table: rooms of two cells each, where skills do what they are asked to do unless a test says otherwise.
"""

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
import rosgraph
import rospy
import rostest
import yaml
from kr3_msgs.msg import (
    AchieveAction,
    AchieveGoal,
    Cell,
    CellArray,
    ExecuteSkillAction,
    ExecuteSkillResult,
    MissionEvent,
    MissionState,
    Status,
)
from kr3_msgs.srv import Tell
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

PLACES = ["office", "main_library", "aux_library", "kitchen", "study_corner", "corridor"]
GOAL = "loc(tb1) = study_corner and not in_hand(rob1, tb1)"


class ScriptedRobot:
    """The cells of a map and five skill servers over one true state."""

    def __init__(self):
        self.lock = threading.Lock()
        self.robot = "office_c1"
        self.book = "aux_library_c0"
        self.held = False
        self.slip_to = None  # where the next drive ends instead
        self.drop = False  # the next drive with the book loses it at its start
        self.people = (
            []
        )  # what the persons do who are asked to hand over: True: hand over, False: never come
        self.asked = 0
        self.hold_search = threading.Event()  # cleared: a search waits until it is cancelled
        self.hold_search.set()
        self.searching = threading.Event()
        self.cells = rospy.Publisher("cells", CellArray, queue_size=1, latch=True)
        self.cells.publish(self._cells())
        self.servers = []
        self.holding = rospy.Publisher("gripper/holding", Bool, queue_size=1, latch=True)
        self.holding.publish(Bool(False))
        for name, work in (
            ("move_to", self._move),
            ("search", self._search),
            ("grasp", self._grasp),
            ("hand_over", self._hand_over),
            ("put_down", self._put_down),
        ):
            server = actionlib.SimpleActionServer("skills/" + name, ExecuteSkillAction, None, False)
            server.execute_callback = lambda goal, s=server, w=work: self._execute(s, w, goal)
            server.execute_thread = threading.Thread(target=server.executeLoop, daemon=True)
            server.execute_thread.start()
            server.start()
            self.servers.append(server)

    @staticmethod
    def _cells():
        message = CellArray()
        names = [f"{place}_c{i}" for place in PLACES for i in range(2)]
        for index, name in enumerate(names):
            cell = Cell(name=name, room=name.rsplit("_", 1)[0], size_x=1.0, size_y=1.0)
            cell.neighbors = [names[k] for k in (index - 1, index + 1) if 0 <= k < len(names)]
            message.cells.append(cell)
            message.travel_distance += [float(abs(index - k)) for k in range(len(names))]
        return message

    def _execute(self, server, work, goal):
        result = ExecuteSkillResult(confidence=1.0, duration_s=1.0)
        cancelled = not work(server, list(goal.arguments), result)
        if cancelled:
            result.status.code = Status.CANCELLED
            server.set_preempted(result)
        else:
            server.set_succeeded(result)

    def _move(self, _server, arguments, result):
        dropped = self.drop and self.held
        if dropped:
            with self.lock:
                self.held = self.drop = False
            self.holding.publish(Bool(False))
            rospy.sleep(0.3)  # the message arrives long before a drive is over
        with self.lock:
            result.outcome = "slipped" if self.slip_to else "reached"
            self.robot, self.slip_to = self.slip_to or arguments[0], None
            if self.held:
                self.book = self.robot
            result.observation = [self.robot]
        return True

    def _search(self, server, arguments, result):
        self.searching.set()
        while not self.hold_search.wait(0.02):
            if server.is_preempt_requested():
                return False
        with self.lock:
            seen = self.book == arguments[0] == self.robot and arguments[1] == "tb1"
        result.outcome = "found" if seen else "not_found"
        return True

    def _grasp(self, _server, arguments, result):
        with self.lock:
            self.held = self.held or (arguments == ["tb1", self.robot] and self.book == self.robot)
            result.outcome = "succeeded" if self.held else "failed"
        self.holding.publish(Bool(self.held))
        return True

    def _hand_over(self, _server, arguments, result):
        with self.lock:
            self.asked += 1
            willing = self.people.pop(0) if self.people else True
            self.held = willing and arguments == ["tb1"] and self.book == self.robot
            result.outcome = "succeeded" if self.held else "failed"
        self.holding.publish(Bool(self.held))
        return True

    def _put_down(self, _server, _arguments, result):
        with self.lock:
            self.held = False
            result.outcome = "succeeded"
        self.holding.publish(Bool(False))
        return True


def start_node(**overrides):
    """Starts executive_node with its configuration file and these parameters on top."""
    name = "/executive_node"
    if rospy.has_param(name):
        rospy.delete_param(name)
    domain = os.path.realpath(rospy.get_param("~domain"))
    with open(rospy.get_param("~config"), encoding="utf-8") as file:
        parameters = yaml.safe_load(file)
    parameters.update(
        domain=f"{domain}/domain.kr3",
        refinement=f"{domain}/refinement.kr3",
        models=f"{domain}/models.yaml",
        bindings=f"{domain}/bindings.yaml",
        scenario=f"{domain}/scenario.yaml",
    )
    parameters.update(overrides)
    rospy.set_param(name, parameters)
    return subprocess.Popen(
        ["rosrun", "kr3_executive", "executive_node"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def stop_node(process):
    """SIGINT, and the exit code."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
    process.communicate(timeout=30)
    return process.returncode


class ExecutiveNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.state_file = os.path.join(cls.folder.name, "state.json")
        cls.robot = ScriptedRobot()
        cls.node = start_node(state_file=cls.state_file, max_backups=500)
        cls.drain = threading.Thread(target=cls._collect, args=(cls.node,), daemon=True)
        cls.drain.start()
        cls.events = []
        rospy.Subscriber("executive/events", MissionEvent, cls.events.append, queue_size=1000)
        cls.client = actionlib.SimpleActionClient("executive/achieve", AchieveAction)
        assert cls.client.wait_for_server(rospy.Duration(60)), "executive_node did not start"

    @staticmethod
    def _collect(process):
        for line in process.stdout:
            print(line, end="")

    @classmethod
    def tearDownClass(cls):
        if cls.node.poll() is None:
            os.killpg(cls.node.pid, signal.SIGINT)
            cls.node.wait(timeout=30)
        cls.folder.cleanup()

    def achieve(self, goal, timeout=120):
        self.client.send_goal(AchieveGoal(goal=goal))
        self.assertTrue(self.client.wait_for_result(rospy.Duration(timeout)), "no result")
        return self.client.get_result()

    def state(self):
        return rospy.wait_for_message("executive/state", MissionState, timeout=10)

    def test_1_unknown_object_is_refused_and_nothing_starts(self):
        result = self.achieve("loc(tb99) = study_corner")
        self.assertEqual(result.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("tb99", result.status.message)
        self.assertFalse(result.achieved)
        self.assertEqual(self.state().state, MissionState.IDLE)

    def test_2_bad_facts_are_refused(self):
        rospy.wait_for_service("executive/tell", timeout=10)
        tell = rospy.ServiceProxy("executive/tell", Tell)
        self.assertEqual(tell("loc(tb1) = moon", True, 0.9).status.code, Status.INVALID_ARGUMENT)
        reply = tell("loc(tb1) = office", True, 1.5)
        self.assertEqual(reply.status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(len(self.state().history), 0)

    def test_3_cancelling_stops_the_running_skill(self):
        self.robot.hold_search.clear()
        self.robot.searching.clear()
        self.client.send_goal(AchieveGoal(goal=GOAL))
        self.assertTrue(self.robot.searching.wait(60), "no search started")
        self.client.cancel_goal()
        self.assertTrue(self.client.wait_for_result(rospy.Duration(20)))
        self.assertEqual(self.client.get_result().status.code, Status.CANCELLED)
        self.robot.hold_search.set()
        self.assertEqual(self.state().state, MissionState.CANCELLED)

    def test_4_brings_the_book_from_where_no_default_expects_it_first(self):
        del self.events[:]
        self.robot.slip_to = "kitchen_c1"  # through a door that nobody had in mind
        result = self.achieve(GOAL)
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertTrue(result.achieved, result.reason)
        self.assertTrue(self.robot.book.startswith("study_corner"))
        self.assertFalse(self.robot.held)
        state = self.state()
        self.assertEqual(state.state, MissionState.SUCCEEDED)
        refuted = [r for r in state.history if r.statement == "loc(tb1) = main_library"]
        self.assertTrue(refuted and not refuted[0].value and refuted[0].confidence > 0.85)
        self.assertIn("move(rob1, kitchen)", [r.statement for r in state.history])
        kinds = [event.kind for event in self.events]
        for kind in (MissionEvent.DIAGNOSIS, MissionEvent.REPLAN, MissionEvent.DONE):
            self.assertIn(kind, kinds)
        self.assertEqual([e.sequence for e in self.events], list(range(len(self.events))))
        for event in self.events:
            self.assertIsInstance(json.loads(event.data), dict)
        texts = [e.text for e in self.events if e.kind == MissionEvent.DIAGNOSIS]
        text = next(t for t in texts if "main_library" in t)
        self.assertIn("tb1 in main_library", text)
        self.assertIn("aux_library", text)

    def test_5_a_goal_that_holds_needs_no_action(self):
        result = self.achieve(GOAL)
        self.assertTrue(result.achieved)
        self.assertEqual((result.hl_actions, result.ll_actions), (0, 0))

    def test_6_a_restarted_node_knows_what_happened(self):
        records = len(self.state().history)
        os.killpg(self.node.pid, signal.SIGINT)
        self.assertEqual(self.node.wait(timeout=30), 0)
        type(self).node = start_node(state_file=self.state_file)
        threading.Thread(target=self._collect, args=(self.node,), daemon=True).start()
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60)))
        master = rosgraph.Master("/executive_node_test")
        self.assertTrue(master.is_online())
        result = self.achieve(GOAL)
        self.assertTrue(result.achieved)
        self.assertEqual(result.ll_actions, 0)
        self.assertEqual(len(self.state().history), records)

    def test_6_ab_a_mission_under_way_goes_on_after_a_crash(self):
        self.robot.book = "aux_library_c0"  # somebody moved it, and says so
        tell = rospy.ServiceProxy("executive/tell", Tell)
        tell.wait_for_service(timeout=10)
        reply = tell("loc(tb1) = aux_library", True, 0.9)
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.addCleanup(self.robot.hold_search.set)
        self.robot.hold_search.clear()
        self.robot.searching.clear()
        self.client.send_goal(AchieveGoal(goal="loc(tb1) = office and not in_hand(rob1, tb1)"))
        self.assertTrue(self.robot.searching.wait(60), "no search started")
        del self.events[:]
        os.killpg(self.node.pid, signal.SIGKILL)
        self.node.wait(timeout=30)
        self.robot.hold_search.set()
        type(self).node = start_node(state_file=self.state_file)
        threading.Thread(target=self._collect, args=(self.node,), daemon=True).start()
        deadline = time.monotonic() + 60
        while MissionEvent.DONE not in [event.kind for event in self.events]:
            told = [event.text for event in self.events][-30:]
            self.assertLess(time.monotonic(), deadline, f"the mission did not end: {told}")
            time.sleep(0.1)
        self.assertTrue(self.robot.book.startswith("office"))
        self.assertFalse(self.robot.held)
        self.assertEqual(self.state().goal, "loc(tb1) = office and not in_hand(rob1, tb1)")
        with open(self.state_file, encoding="utf-8") as file:
            self.assertNotIn("mission", json.load(file))

    def test_6_ac_nothing_is_left_to_cancel(self):
        cancel = rospy.ServiceProxy("executive/cancel", Trigger)
        cancel.wait_for_service(timeout=10)
        self.assertFalse(cancel().success)

    def restart(self, **overrides):
        """A node without a past, with these parameters on top."""
        os.killpg(self.node.pid, signal.SIGINT)
        self.assertEqual(self.node.wait(timeout=30), 0)
        type(self).node = start_node(max_backups=500, **overrides)
        threading.Thread(target=self._collect, args=(self.node,), daemon=True).start()
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60)))
        self.robot.robot, self.robot.book, self.robot.held = "office_c1", "main_library_c0", False

    def test_6_b_a_person_who_does_not_come_is_asked_again(self):
        domain = os.path.realpath(rospy.get_param("~domain"))
        self.restart(bindings=f"{domain}/bindings_hand_over.yaml")
        self.robot.people, self.robot.asked = [False], 0
        result = self.achieve("in_hand(rob1, tb1)")
        self.assertTrue(result.achieved, result.reason)
        self.assertTrue(self.robot.held)
        self.assertEqual(self.robot.asked, 2)
        grasps = [r for r in self.state().history if r.statement == "grasp(rob1, tb1)"]
        self.assertEqual(len(grasps), 1, "the high level hears of one grasp")

    def test_7_bad_parameters_are_all_named_at_once(self):
        os.killpg(self.node.pid, signal.SIGINT)
        self.node.wait(timeout=30)
        process = start_node(threshold=1.5, treshold=0.9)
        output, _ = process.communicate(timeout=30)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("threshold", output)
        self.assertIn("treshold", output)

    def test_8_what_is_missing_is_named(self):
        process = start_node(peer_deadline_s=1.0, models="/nonexistent/models.yaml")
        output, _ = process.communicate(timeout=30)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("/nonexistent/models.yaml", output)


if __name__ == "__main__":
    rospy.init_node("executive_node_test")
    rostest.rosrun("kr3_executive", "executive_node_contract", ExecutiveNodeTest, sys.argv)
