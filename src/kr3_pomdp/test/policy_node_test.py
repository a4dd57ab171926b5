#!/usr/bin/python3
"""Contract of policy_node: it solves, answers, reports progress, refuses bad input and survives it."""
import subprocess
import unittest

import actionlib
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from kr3_msgs.msg import SolveAction, SolveGoal, Status
from kr3_msgs.srv import GetPolicyAction, UpdateBelief

TIGER = """
discount: 0.95
values: reward
states: left right
actions: listen open_left open_right
observations: hear_left hear_right
T: listen identity
T: open_left uniform
T: open_right uniform
O: listen
0.85 0.15
0.15 0.85
O: open_left uniform
O: open_right uniform
R: listen : * : * : * -1
R: open_left : left : * : * -100
R: open_left : right : * : * 10
R: open_right : left : * : * 10
R: open_right : right : * : * -100
"""


def maze(size: int) -> str:
    """A model that stays unsolved for long: a noisy ring of `size` places, all but one looking alike."""
    lines = ["discount: 0.99", "values: reward", f"states: {size}", "actions: 3", "observations: 2"]
    for s in range(size):
        for a, (left, right) in enumerate([(0.6, 0.2), (0.2, 0.6), (0.1, 0.1)]):
            lines.append(f"T: {a} : {s} : {(s - 1) % size} {left}")
            lines.append(f"T: {a} : {s} : {(s + 1) % size} {right}")
            lines.append(f"T: {a} : {s} : {s} {1 - left - right:.3f}")
        seen = 0.5 + 0.4 * ((s * s) % 7 == 1)
        lines.append(f"O: * : {s} : 0 {seen}")
        lines.append(f"O: * : {s} : 1 {1 - seen:.3f}")
        lines.append(f"R: 2 : {s} : * : * {10 if s == 0 else -1}")
    return "\n".join(lines) + "\n"


class PolicyNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = actionlib.SimpleActionClient("pomdp/solve", SolveAction)
        if not cls.client.wait_for_server(rospy.Duration(20)):
            raise RuntimeError("pomdp/solve did not come up")
        rospy.wait_for_service("pomdp/get_action", timeout=20)
        rospy.wait_for_service("pomdp/update_belief", timeout=20)
        get_action = rospy.ServiceProxy("pomdp/get_action", GetPolicyAction)
        update_belief = rospy.ServiceProxy("pomdp/update_belief", UpdateBelief)
        cls.get_action = staticmethod(
            lambda policy, belief: get_action(policy_id=policy, belief=belief)
        )
        cls.update_belief = staticmethod(
            lambda policy, belief, action, observation: update_belief(
                policy_id=policy, belief=belief, action=action, observation=observation
            )
        )

    def solve(self, **fields):
        self.client.send_goal(SolveGoal(**{"format": "pomdp", **fields}))
        self.assertTrue(self.client.wait_for_result(rospy.Duration(40)))
        return self.client.get_result()

    def test_solves_and_answers(self):
        result = self.solve(model=TIGER, precision=0.001)
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertLessEqual(result.lower_bound, result.upper_bound)
        self.assertAlmostEqual(result.lower_bound, 19.37, delta=0.01)
        action = self.get_action(result.policy_id, [0.5, 0.5])
        self.assertEqual((action.status.code, action.action), (Status.OK, "listen"))
        self.assertAlmostEqual(action.value, 19.37, delta=0.01)
        self.assertEqual(self.get_action(result.policy_id, [0.99, 0.01]).action, "open_right")
        update = self.update_belief(result.policy_id, [0.5, 0.5], "listen", "hear_left")
        self.assertEqual(update.status.code, Status.OK)
        self.assertAlmostEqual(update.belief[0], 0.85)
        self.assertAlmostEqual(update.probability, 0.5)

    def test_remembers_by_content(self):
        first = self.solve(model=TIGER, precision=0.005)
        again = self.solve(model=TIGER, precision=0.005)
        other = self.solve(model=TIGER, precision=0.006)
        self.assertTrue(again.cached)
        self.assertEqual(again.policy_id, first.policy_id)
        self.assertFalse(other.cached)
        self.assertNotEqual(other.policy_id, first.policy_id)

    def test_preemption_returns_the_policy_so_far(self):
        feedback = []
        self.client.send_goal(
            SolveGoal(format="pomdp", model=maze(40), precision=1e-9), feedback_cb=feedback.append
        )
        deadline = rospy.Time.now() + rospy.Duration(20)
        while len(feedback) < 3 and rospy.Time.now() < deadline:
            self.client.wait_for_result(rospy.Duration(0.05))
        self.assertGreaterEqual(len(feedback), 3)
        self.assertLessEqual(feedback[0].lower_bound, feedback[-1].lower_bound)
        self.assertGreaterEqual(feedback[0].upper_bound, feedback[-1].upper_bound)
        # The services answer while it solves.
        self.assertEqual(self.get_action("none", [1.0]).status.code, Status.NOT_FOUND)
        self.client.cancel_goal()
        self.assertTrue(self.client.wait_for_result(rospy.Duration(20)))
        self.assertEqual(self.client.get_state(), GoalStatus.PREEMPTED)
        result = self.client.get_result()
        self.assertEqual(result.status.code, Status.OK)
        self.assertEqual(self.get_action(result.policy_id, [1.0 / 40] * 40).status.code, Status.OK)

    def test_refuses_bad_models(self):
        result = self.solve(model=TIGER.replace("0.85 0.15", "0.85 0.25"))
        self.assertEqual(self.client.get_state(), GoalStatus.ABORTED)
        self.assertEqual(result.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("model:10:1:", result.status.message)
        for fields in [
            {"model": ""},
            {"model": TIGER, "format": "xml"},
            {"model": TIGER, "precision": -1.0},
            {"model": TIGER, "precision": float("nan")},
            {"model": TIGER, "time_limit": rospy.Duration(1000)},
        ]:
            self.assertEqual(self.solve(**fields).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(self.solve(model=TIGER).status.code, Status.OK)

    def test_refuses_bad_requests(self):
        policy = self.solve(model=TIGER).policy_id
        self.assertEqual(self.get_action("nowhere", [0.5, 0.5]).status.code, Status.NOT_FOUND)
        self.assertEqual(self.get_action(policy, [1.0]).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(self.get_action(policy, [0.5, 0.6]).status.code, Status.INVALID_ARGUMENT)
        for belief, action, observation in [
            ([0.5, 0.5], "fly", "hear_left"),
            ([0.5, 0.5], "listen", "smell"),
            ([], "listen", "hear_left"),
        ]:
            code = self.update_belief(policy, belief, action, observation).status.code
            self.assertEqual(code, Status.INVALID_ARGUMENT)

    def test_refuses_unknown_parameters(self):
        run = subprocess.run(
            ["rosrun", "kr3_pomdp", "policy_node", "__name:=wrong_node", "_cache_megabyte:=3"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=30,
            check=False,
        )
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(b"cache_megabyte", run.stdout)


if __name__ == "__main__":
    rospy.init_node("policy_node_test")
    rostest.rosrun("kr3_pomdp", "policy_node_test", PolicyNodeTest)
