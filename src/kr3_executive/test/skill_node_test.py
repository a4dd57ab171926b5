#!/usr/bin/python3
"""Contract of skill_node, with a fake of the robot, the navigator and the detector around it."""
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
from fake_robot import HELD, FakeRobot
from kr3_msgs.msg import ExecuteSkillAction, ExecuteSkillGoal, Status
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

DEADLINE_S = 40.0


class SkillNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.world = FakeRobot(
            [("hall_west", "hall", 4.0), ("hall_east", "hall", 4.0)],
            {"cup": (3.0, 1.0), "book": None},
        )
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
            self.world.objects["cup"] = (3.0, 1.0)
            self.world.objects["book"] = None
            self.world.reachable = True
            self.world.holding.publish(Bool(False))
            self.world.stand_at(2.0, 2.0)
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
        self.world.objects["cup"] = (1.0, 2.2)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "found")
        self.assertEqual(result.observation, ["hall_west"])
        self.assertAlmostEqual(result.confidence, 0.95, places=5)
        self.assertGreater(result.duration_s, 0.0)

    def test_search_says_where_else_or_nothing(self):
        self.world.objects["cup"] = (5.0, 2.0)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "not_found")
        self.assertEqual(result.observation, ["hall_east"])
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        self.assertEqual(result.observation, [])

    def test_search_tells_what_it_sees_by_the_way(self):
        self.world.objects["book"] = (6.5, 2.2)
        result = self.run_skill("search", ["hall_west", "cup"])
        self.assert_ok(result, "found")
        told = {sighting.literal: sighting.confidence for sighting in result.sightings}
        self.assertLessEqual(set(told), {"stands(book) = hall_east"})
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        told = {sighting.literal: sighting.confidence for sighting in result.sightings}
        self.assertEqual(told.pop("stands(book) = hall_east", None), 0.95)
        self.assertLessEqual(set(told), {"stands(cup) = hall_west"})
        self.world.objects["book"] = None
        result = self.run_skill("search", ["hall_west", "book"])
        self.assert_ok(result, "not_found")
        self.assertEqual([s.literal for s in result.sightings], ["stands(cup) = hall_west"])

    def test_grasps_and_puts_down(self):
        self.assert_ok(self.run_skill("search", ["hall_west", "cup"]), "found")
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "succeeded")
        self.assertEqual(self.world.objects["cup"], HELD)
        self.assertEqual(self.world.speed, 0.0)
        again = self.run_skill("grasp", ["cup", "hall_west"])
        self.assertEqual(again.status.code, Status.FAILED_PRECONDITION)
        self.assert_ok(self.run_skill("put_down", ["cup"]), "succeeded")
        self.assertIsInstance(self.world.objects["cup"], tuple)

    def test_grasp_fails_where_it_cannot_get_or_see(self):
        self.world.reachable = False
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "failed")
        self.world.reachable = True
        self.world.objects["cup"] = None
        self.assert_ok(self.run_skill("grasp", ["cup", "hall_west"]), "failed")

    def test_hand_over_waits_for_a_person(self):
        requests = []
        rospy.Subscriber("hand_over/request", String, lambda m: requests.append(m.data))
        self.assert_ok(self.run_skill("hand_over", ["cup"], time_limit=1.0), "failed")
        self.world.objects["cup"] = (2.5, 2.0)
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

    def test_a_person_may_refuse(self):
        client = self.clients["hand_over"]
        asked = threading.Event()
        subscriber = rospy.Subscriber(
            "hand_over/request", String, lambda m: asked.set() if m.data else asked.clear()
        )
        client.send_goal(ExecuteSkillGoal(skill="hand_over", arguments=["cup"]))
        self.assertTrue(asked.wait(DEADLINE_S))
        self.assertTrue(rospy.ServiceProxy("hand_over/refuse", Trigger)().success)
        self.assertTrue(client.wait_for_result(rospy.Duration(DEADLINE_S)))
        subscriber.unregister()
        status = client.get_result().status
        self.assertEqual(status.code, Status.UNAVAILABLE)
        self.assertIn("refused to hand over cup", status.message)

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
        self.world.objects["cup"] = None
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
