#!/usr/bin/python3
"""Contract of reasoner_node: it answers, plans, refuses bad input with a Status, and survives it."""

import subprocess
import sys
import unittest

import actionlib
import rospy
import rostest
from kr3_msgs.msg import HistoryRecord, MakePlanAction, MakePlanGoal, Status
from kr3_msgs.srv import (
    AddRecords,
    Diagnose,
    Entails,
    EntailsRequest,
    ExplainLiteral,
    GetState,
    SetHistory,
)

TIMEOUT_S = 20.0


def service(name, kind):
    rospy.wait_for_service(name, timeout=TIMEOUT_S)
    return rospy.ServiceProxy(name, kind)


def init(statement, value):
    return HistoryRecord(
        kind=HistoryRecord.INIT,
        statement=statement,
        value=value,
        step=0,
        confidence=1.0,
        source="test",
    )


START = [init("on(left)", False), init("on(right)", False), init("shows(d) = 2", True)]


class ReasonerNodeTest(unittest.TestCase):
    def setUp(self):
        self.set_history = service("reasoner/set_history", SetHistory)
        reply = self.set_history(START)
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.assertEqual(reply.num_records, 3)

    def test_answers_questions(self):
        reply = service("reasoner/entails", Entails)("dark", 0)
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.assertEqual(reply.answer, EntailsRequest.TRUE)
        self.assertTrue(reply.possible)
        self.assertTrue(service("reasoner/diagnose", Diagnose)().consistent)
        why = service("reasoner/explain", ExplainLiteral)("-on(left)", 0)
        self.assertTrue(why.entailed)
        self.assertEqual(why.records, ["init(on(left), false)"])
        state = service("reasoner/get_state", GetState)(0, False)
        self.assertIn("shows(d) = 2", [item.literal for item in state.literals])

    def test_plans(self):
        client = actionlib.SimpleActionClient("reasoner/plan", MakePlanAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(TIMEOUT_S)))
        client.send_goal_and_wait(
            MakePlanGoal(goal="lit(red) and not lit(green)"), rospy.Duration(TIMEOUT_S)
        )
        result = client.get_result()
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertEqual(len(result.plans), 1)
        self.assertEqual([s.actions for s in result.plans[0].steps], [["flip(left)"]])
        client.send_goal_and_wait(MakePlanGoal(goal="lit(blue)"), rospy.Duration(TIMEOUT_S))
        self.assertEqual(client.get_result().status.code, Status.INVALID_ARGUMENT)

    def test_refuses_bad_requests_and_changes_nothing(self):
        add_records = service("reasoner/add_records", AddRecords)
        stale = add_records(7, [init("dark", True)])
        self.assertEqual(stale.status.code, Status.FAILED_PRECONDITION)
        wrong = add_records(3, [init("on(middle)", True)])
        self.assertEqual(wrong.status.code, Status.INVALID_ARGUMENT)
        self.assertIn("middle", wrong.status.message)
        self.assertEqual(wrong.num_records, 3)
        entails = service("reasoner/entails", Entails)
        self.assertEqual(entails("lid(red)", 0).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(entails("lit(red)", 99).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(entails("lit(red)", 0).status.code, Status.OK)

    def test_a_bad_domain_stops_the_start(self):
        run = subprocess.run(
            ["rosrun", "kr3_reasoner", "reasoner_node", "__name:=other", "_domain:=/nowhere.kr3"],
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("/nowhere.kr3", run.stdout + run.stderr)


if __name__ == "__main__":
    rospy.init_node("reasoner_node_test")
    sys.exit(rostest.rosrun("kr3_reasoner", "reasoner_node_test", ReasonerNodeTest) or 0)
