#!/usr/bin/python3
"""Whole missions of executive_node with skill_node, around a robot that speaks the real topics and can lose things."""
import os
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
from executive_node_test import start_node, stop_node
from fake_robot import HELD, FakeRobot
from kr3_msgs.msg import (
    AchieveAction,
    AchieveGoal,
    ExecuteSkillAction,
    ExecuteSkillResult,
    HistoryRecord,
    MissionEvent,
    MissionState,
    Status,
)
from std_msgs.msg import String
from std_srvs.srv import Trigger

DEADLINE_S = 90.0
PLACES = ["office", "main_library", "kitchen", "study_corner", "aux_library", "corridor"]
CELLS = [(f"{place}_c{i}", place, 2.0) for place in PLACES for i in range(2)]
IN_MAIN_LIBRARY = (7.0, 2.8)
IN_OFFICE = (3.0, 2.0)


class Person:
    """Answers requests to hand over tb1 as told: "come", "refuse" or "stay away"."""

    def __init__(self, robot):
        self.robot = robot
        self.answers = []
        self.requests = []
        rospy.Subscriber("hand_over/request", String, self._on_request)

    def _on_request(self, message):
        if not message.data:
            return
        self.requests.append(message.data)
        answer = self.answers.pop(0)
        if answer == "stay away":
            return
        if answer == "come":
            with self.robot.lock:
                self.robot.objects["tb1"] = self.robot.in_front()
        service = "hand_over/confirm" if answer == "come" else "hand_over/refuse"
        rospy.ServiceProxy(service, Trigger)()


class WholeMissionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.domain = os.path.realpath(rospy.get_param("~domain"))
        cls.robot = FakeRobot(CELLS, {"tb1": IN_MAIN_LIBRARY})
        cls.drop = False  # the next drive with something in the gripper loses it at its start
        cls.driver = actionlib.SimpleActionServer(
            "skills/move_to", ExecuteSkillAction, cls.move_to, auto_start=False
        )
        cls.driver.start()
        cls.person = Person(cls.robot)
        rospy.set_param(
            "/skill_node",
            {
                "objects": f"{cls.domain}/objects.yaml",
                "bindings": f"{cls.domain}/bindings.yaml",
                "turn_speed": 2.5,
            },
        )
        cls.skills = subprocess.Popen(["rosrun", "kr3_executive", "skill_node"])
        cls.executive = None
        cls.events = []
        rospy.Subscriber("executive/events", MissionEvent, cls.events.append, queue_size=1000)

    @classmethod
    def move_to(cls, goal):
        """The navigator's skill: the robot is where it was told to go, at once."""
        if cls.drop and cls.robot.release():
            cls.drop = False
            rospy.sleep(0.3)  # the touch sensor is heard long before a drive is over
        cell = next(c for c in cls.robot.places.cells if c.name == goal.arguments[0])
        cls.robot.stand_at(cell.center.x, cell.center.y)
        rospy.sleep(0.2)  # the pose is published before the result
        result = ExecuteSkillResult(outcome="reached", observation=[cell.name], confidence=1.0)
        cls.driver.set_succeeded(result)

    @classmethod
    def tearDownClass(cls):
        stop_node(cls.executive)
        cls.skills.send_signal(signal.SIGINT)
        code = cls.skills.wait(30)
        cls.folder.cleanup()
        if code != 0:
            raise RuntimeError(f"skill_node ended with {code}")

    def start(self, bindings):
        """A node without a past, and the world as at first."""
        if self.executive is not None:
            self.assertEqual(stop_node(self.executive), 0)
        type(self).executive = start_node(bindings=bindings, max_backups=500)
        threading.Thread(target=self.echo, args=(self.executive,), daemon=True).start()
        self.reset()
        self.client = actionlib.SimpleActionClient("executive/achieve", AchieveAction)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(60)))

    @staticmethod
    def echo(process):
        for line in process.stdout:
            print(line, end="")

    def reset(self):
        self.robot.release()
        self.robot.objects["tb1"] = IN_MAIN_LIBRARY
        self.robot.stand_at(*IN_OFFICE)

    def achieve(self, goal):
        del self.events[:]
        self.client.send_goal(AchieveGoal(goal=goal))
        self.assertTrue(self.client.wait_for_result(rospy.Duration(DEADLINE_S)), "no result")
        return self.client.get_result()

    def history(self):
        state = rospy.wait_for_message("executive/state", MissionState, timeout=10)
        return [(r.kind, r.statement, bool(r.value)) for r in state.history]

    def test_1_what_falls_out_of_the_gripper_is_felt_and_fetched(self):
        self.start(f"{self.domain}/bindings.yaml")
        type(self).drop = True
        result = self.achieve("loc(tb1) = kitchen and not in_hand(rob1, tb1)")
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertTrue(result.achieved, result.reason)
        self.assertFalse(self.drop)
        left, right = 8.0, 12.0
        self.assertTrue(left < self.robot.objects["tb1"][0] < right, self.robot.objects)
        history = self.history()
        self.assertEqual(history.count((HistoryRecord.HPD, "grasp(rob1, tb1)", True)), 2)
        lost = [
            (kind, statement, value)
            for kind, statement, value in history
            if kind == HistoryRecord.OBS and "in_hand(rob1, tb1)" in statement
        ]
        held = [statement.startswith("-") != value for _, statement, value in lost]
        self.assertEqual(held, [True, False, True, False], lost)
        diagnoses = [e.text for e in self.events if e.kind == MissionEvent.DIAGNOSIS]
        self.assertTrue(any("exo_drop(rob1, tb1)" in text for text in diagnoses), diagnoses)

    def test_2_a_person_hands_the_book_over_when_asked_again(self):
        bindings = pathlib.Path(self.domain, "bindings_hand_over.yaml").read_text(encoding="utf-8")
        self.assertIn("time_limit_s: 60 ", bindings)
        impatient = pathlib.Path(self.folder.name, "bindings.yaml")
        impatient.write_text(
            bindings.replace("time_limit_s: 60 ", "time_limit_s: 2 "), encoding="utf-8"
        )
        self.start(str(impatient))
        self.person.answers, self.person.requests = ["stay away", "come"], []
        result = self.achieve("in_hand(rob1, tb1)")
        self.assertTrue(result.achieved, f"{result.reason} {result.status.message}")
        self.assertEqual(self.robot.objects["tb1"], HELD)
        self.assertEqual(len(self.person.requests), 2)
        self.assertTrue(all("tb1" in request for request in self.person.requests))
        history = self.history()
        self.assertEqual(history.count((HistoryRecord.HPD, "grasp(rob1, tb1)", True)), 1)
        self.assertNotIn((HistoryRecord.OBS, "loc(tb1) = main_library", False), history)

    def test_3_who_refuses_three_times_ends_the_mission_and_nothing_false_is_learned(self):
        self.start(f"{self.domain}/bindings_hand_over.yaml")
        self.person.answers, self.person.requests = ["refuse"] * 10, []
        result = self.achieve("in_hand(rob1, tb1)")
        self.assertFalse(result.achieved)
        self.assertEqual(result.status.code, Status.UNAVAILABLE)
        self.assertIn("refused to hand over tb1", result.status.message)
        self.assertEqual(len(self.person.requests), 3)  # max_skill_retries is 2
        history = self.history()
        self.assertNotIn((HistoryRecord.OBS, "loc(tb1) = main_library", False), history)
        self.assertNotIn((HistoryRecord.HPD, "grasp(rob1, tb1)", True), history)
        self.person.answers = ["come"]
        result = self.achieve("in_hand(rob1, tb1)")
        self.assertTrue(result.achieved, f"{result.reason} {result.status.message}")


if __name__ == "__main__":
    rospy.init_node("whole_mission_test")
    rostest.rosrun("kr3_executive", "whole_mission", WholeMissionTest, sys.argv)
