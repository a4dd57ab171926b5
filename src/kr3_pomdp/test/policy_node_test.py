#!/usr/bin/python3
"""Contract of policy_node's action: it solves, reports, queues, is preempted, and survives bad input."""
import os
import signal
import subprocess
import sys
import time
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from kr3_msgs.msg import SolveFeedback, Status
from policy_node_support import SWITCH_POMDPX, TIGER, Goal, Services, maze, uniform

VANISHING_CLIENT = """
import os, sys
import rospy
sys.path.insert(0, {directory!r})
from policy_node_support import Goal, maze
from kr3_msgs.msg import SolveFeedback
rospy.init_node("vanishing_client")
goal = Goal(model=maze(41), precision=1e-9)
goal.wait_for_phase(SolveFeedback.SOLVING)
rospy.signal_shutdown("going")
"""


class PolicyNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.services = Services()

    def solve(self, **fields):
        return Goal(**fields).result()

    def code_of(self, **fields) -> int:
        return self.solve(**fields).status.code

    def test_solves_and_answers(self):
        result = self.solve(format="pomdp", model=TIGER, precision=0.001)
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertLessEqual(result.lower_bound, result.upper_bound)
        self.assertAlmostEqual(result.lower_bound, 19.37, delta=0.01)
        self.assertEqual(result.stop_reason, "precision")
        self.assertGreater(result.num_alpha_vectors, 0)
        policy = result.policy_id
        action = self.services.get_action(policy_id=policy, belief=[0.5, 0.5])
        self.assertEqual((action.status.code, action.action), (Status.OK, "listen"))
        self.assertAlmostEqual(action.value, 19.37, delta=0.01)
        action = self.services.get_action(policy_id=policy, belief=[0.99, 0.01])
        self.assertEqual(action.action, "open_right")
        update = self.services.update_belief(
            policy_id=policy, belief=[0.5, 0.5], action="listen", observation="hear_left"
        )
        self.assertEqual(update.status.code, Status.OK)
        self.assertAlmostEqual(update.belief[0], 0.85)
        self.assertAlmostEqual(update.probability, 0.5)

    def test_reads_pomdpx_and_finds_the_format_out(self):
        result = self.solve(model=SWITCH_POMDPX, precision=0.01)
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertEqual(self.code_of(model=SWITCH_POMDPX, format="pomdpx", precision=0.01), 0)
        wrong = self.solve(model=SWITCH_POMDPX.replace("0.7 0.3", "0.7 0.4"))
        self.assertEqual(wrong.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("model", wrong.status.message)
        self.assertEqual(self.code_of(model=SWITCH_POMDPX, format="pomdp"), Status.INVALID_ARGUMENT)

    def test_remembers_by_content(self):
        first = self.solve(model=TIGER, precision=0.005)
        again = self.solve(model=TIGER, precision=0.005)
        self.assertTrue(again.cached)
        self.assertEqual(again.policy_id, first.policy_id)
        # A solution that is precise enough answers, one that is not does not.
        rougher = self.solve(model=TIGER, precision=0.5)
        self.assertTrue(rougher.cached)
        self.assertLessEqual(rougher.upper_bound - rougher.lower_bound, 0.5)
        finer = self.solve(model=TIGER, precision=1e-7)
        self.assertFalse(finer.cached)
        self.assertNotEqual(finer.policy_id, first.policy_id)
        self.assertFalse(self.solve(model=TIGER, precision=0.5, ignore_cache=True).cached)

    def test_counted_work_repeats_exactly(self):
        fields = {"model": maze(12), "precision": 1e-9, "max_backups": 300}
        first = self.solve(**fields)
        self.assertEqual(first.stop_reason, "backup limit")
        self.assertEqual(first.backups, 300)
        again = self.solve(ignore_cache=True, **fields)
        self.assertFalse(again.cached)
        self.assertEqual(
            (again.lower_bound, again.upper_bound, again.policy_id),
            (first.lower_bound, first.upper_bound, first.policy_id),
        )

    def test_keeps_limits_of_time_and_memory(self):
        result = self.solve(model=maze(42), precision=1e-9, time_limit=rospy.Duration(0.5))
        self.assertEqual(result.stop_reason, "time limit")
        self.assertLess(result.wall_s, 2.0)
        result = self.solve(model=maze(43), precision=1e-9, max_memory_bytes=1 << 20)
        self.assertEqual(result.stop_reason, "memory limit")
        result = self.solve(
            model=maze(20), precision=1e-9, time_limit=rospy.Duration(0.5), num_threads=2
        )
        self.assertEqual((result.status.code, result.stop_reason), (Status.OK, "time limit"))
        for fields in [{"num_threads": 1000}, {"max_memory_bytes": 1 << 50}]:
            self.assertEqual(self.code_of(model=TIGER, **fields), Status.INVALID_ARGUMENT)

    def test_preemption_returns_the_policy_so_far(self):
        goal = Goal(model=maze(40), precision=1e-9)
        goal.wait_for_phase(SolveFeedback.SOLVING, count=4)
        known = [f for f in goal.feedback if f.num_alpha_vectors > 0]
        self.assertLessEqual(known[0].lower_bound, known[-1].lower_bound)
        self.assertGreaterEqual(known[0].upper_bound, known[-1].upper_bound)
        self.assertGreater(known[-1].memory_bytes, 0)
        # The services answer while it solves.
        code = self.services.get_action(policy_id="none", belief=[1.0]).status.code
        self.assertEqual(code, Status.NOT_FOUND)
        goal.cancel()
        result = goal.result()
        self.assertEqual(goal.state(), GoalStatus.PREEMPTED)
        self.assertEqual((result.status.code, result.stop_reason), (Status.OK, "cancelled"))
        action = self.services.get_action(policy_id=result.policy_id, belief=[1.0 / 40] * 40)
        self.assertEqual(action.status.code, Status.OK)

    def test_goals_wait_in_order_and_known_ones_do_not(self):
        self.solve(model=TIGER, precision=0.01)
        first = Goal(model=maze(44), precision=1e-9)
        first.wait_for_phase(SolveFeedback.SOLVING)
        second = Goal(model=TIGER.replace("0.95", "0.94"), precision=0.01)
        third = Goal(model=TIGER.replace("0.95", "0.93"), precision=0.01)
        self.assertEqual(second.wait_for_phase(SolveFeedback.QUEUED).num_ahead, 1)
        self.assertEqual(third.wait_for_phase(SolveFeedback.QUEUED).num_ahead, 2)
        self.assertTrue(self.solve(model=TIGER, precision=0.01).cached)
        third.cancel()
        self.assertEqual(third.result().status.code, Status.CANCELLED)
        self.assertIn(third.state(), (GoalStatus.PREEMPTED, GoalStatus.RECALLED))
        first.cancel()
        self.assertEqual(first.result().status.code, Status.OK)
        self.assertEqual(second.result().status.code, Status.OK)
        self.assertEqual(second.state(), GoalStatus.SUCCEEDED)

    def test_preemption_while_reading_is_prompt(self):
        goal = Goal(model=uniform(1300, 5), precision=1e-9)
        goal.wait_for_phase(SolveFeedback.READING)
        goal.cancel()
        start = time.monotonic()
        result = goal.result(timeout=5.0)
        self.assertLess(time.monotonic() - start, 4.0)
        self.assertIn(result.status.code, (Status.CANCELLED, Status.OK))
        self.assertEqual(goal.state(), GoalStatus.PREEMPTED)

    def test_goals_of_a_client_that_vanished_end(self):
        directory = os.path.dirname(os.path.abspath(__file__))
        subprocess.run(
            [sys.executable, "-c", VANISHING_CLIENT.format(directory=directory)],
            check=True,
            timeout=30,
        )
        start = time.monotonic()
        self.assertEqual(self.code_of(model=TIGER.replace("0.95", "0.92")), Status.OK)
        self.assertLess(time.monotonic() - start, 10.0)  # the goal would have taken 30 s

    def test_refuses_bad_models(self):
        result = self.solve(model=TIGER.replace("0.85 0.15", "0.85 0.25"))
        self.assertEqual(result.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("model:10:1:", result.status.message)
        self.assertIn("sums to 1.1", result.status.message)
        for fields in [
            {"model": ""},
            {"model": TIGER, "format": "xml"},
            {"model": TIGER, "precision": -1.0},
            {"model": TIGER, "precision": float("nan")},
            {"model": TIGER, "time_limit": rospy.Duration(1000)},
            {"model": TIGER.replace("identity", "idntity")},
            {"model": TIGER.replace("discount: 0.95", "discount: 1.0")},
            {"model": "\x00\xff" * 100},
            {"model": "<pomdpx></pomdpx>"},
        ]:
            goal = Goal(**fields)
            self.assertEqual(goal.result().status.code, Status.INVALID_ARGUMENT, str(fields)[:80])
            self.assertEqual(goal.state(), GoalStatus.ABORTED)
        self.assertEqual(self.code_of(model=TIGER), Status.OK)

    def test_refuses_models_that_are_too_large(self):
        for model, said in [
            (uniform(9000000, 2), "9000000 states"),
            (uniform(250000, 100), "25000000 rows"),
            (uniform(100000, 2), "entries"),
            ("# " + "x" * (1 << 20) + TIGER, "bytes"),
        ]:
            start = time.monotonic()
            result = self.solve(model=model)
            self.assertEqual(result.status.code, Status.RESOURCE_EXHAUSTED)
            self.assertIn(said, result.status.message)
            self.assertLess(time.monotonic() - start, 5.0)
        self.assertEqual(self.code_of(model=TIGER), Status.OK)

    def test_ends_soon_while_solving(self):
        node = subprocess.Popen(
            ["rosrun", "kr3_pomdp", "policy_node", "__ns:=ending", "__name:=ending_node"]
        )
        try:
            goal = Goal(namespace="ending/", model=maze(45), precision=1e-9)
            goal.wait_for_phase(SolveFeedback.SOLVING)
            start = time.monotonic()
            node.send_signal(signal.SIGINT)
            self.assertEqual(node.wait(timeout=10), 0)
            self.assertLess(time.monotonic() - start, 5.0)
        finally:
            node.kill()
            node.wait()

    def test_refuses_bad_parameters(self):
        for parameter, value in [
            ("cache_megabyte", 3),
            ("solve_niceness", 40),
            ("load_at_start", ["missing"]),
        ]:
            rospy.set_param(f"/wrong_node/{parameter}", value)
            run = subprocess.run(
                ["rosrun", "kr3_pomdp", "policy_node", "__name:=wrong_node"],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=30,
                check=False,
            )
            rospy.delete_param("/wrong_node")
            self.assertNotEqual(run.returncode, 0)
            said = "missing" if parameter == "load_at_start" else parameter
            self.assertIn(said, run.stdout.decode())


if __name__ == "__main__":
    rospy.init_node("policy_node_test")
    rostest.rosrun("kr3_pomdp", "policy_node_test", PolicyNodeTest)
