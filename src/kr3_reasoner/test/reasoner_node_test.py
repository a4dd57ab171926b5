#!/usr/bin/python3
"""Contract of reasoner_node: it answers, plans, refuses bad input with a Status, and survives it."""

import contextlib
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import actionlib
import rosnode
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from kr3_msgs.msg import (
    Assumption,
    HistoryRecord,
    MakePlanAction,
    MakePlanGoal,
    MakePlanResult,
    Reason,
    Status,
)
from kr3_msgs.srv import (
    AddRecords,
    Diagnose,
    DiagnoseRequest,
    Entails,
    EntailsRequest,
    ExplainLiteral,
    FindRelevant,
    FindRetractions,
    GetPossibleValues,
    GetState,
    ListModels,
    ProgressHistory,
    ReloadDomain,
    SetHistory,
    Translate,
    WhatIf,
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


def happened(action, step):
    return HistoryRecord(kind=HistoryRecord.HPD, statement=action, step=step, confidence=1.0)


def observed(statement, value, step, confidence=1.0):
    return HistoryRecord(
        kind=HistoryRecord.OBS,
        statement=statement,
        value=value,
        step=step,
        confidence=confidence,
        source="test",
    )


class Bytes(str):
    """A text that goes over the wire as these bytes, be they UTF-8 or not."""

    def __new__(cls, raw):
        text = str.__new__(cls, "?")
        text.raw = raw
        return text

    def encode(self, *_):
        return self.raw


SWITCHES = """sorts
  switch = {left, right}.
fluents
  inertial on(switch).
actions
  flip(switch).
axioms
  flip(S) causes on(S) if -on(S).
  flip(S) causes -on(S) if on(S).
"""


@contextlib.contextmanager
def started_node(folder):
    """A node of its own, in the namespace `reloaded`, and its domain file."""
    domain = Path(folder) / "switches.kr3"
    domain.write_text(SWITCHES, encoding="utf-8")
    command = ["rosrun", "kr3_reasoner", "reasoner_node", "__ns:=reloaded", f"_domain:={domain}"]
    with subprocess.Popen(command) as process:
        try:
            yield domain
        finally:
            process.terminate()
            process.wait(TIMEOUT_S)


def diagnostics(name="reasoner_node: reasoner"):
    """The key-value pairs of a node's next report."""
    while True:
        for status in rospy.wait_for_message("/diagnostics", DiagnosticArray, TIMEOUT_S).status:
            if status.name.lstrip("/") == name.lstrip("/"):
                return {pair.key: pair.value for pair in status.values}


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

    def test_diagnoses_with_words_and_prices(self):
        surprise = [happened("flip(left)", 0), observed("lit(red)", False, 1)]
        self.assertEqual(service("reasoner/add_records", AddRecords)(3, surprise).num_records, 5)
        diagnose = service("reasoner/diagnose", Diagnose)
        reply = diagnose()
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.assertEqual(reply.explanations, ["init(broken(red), true)"])
        self.assertEqual((reply.cost, reply.alternatives[0].price), (1, 1))
        self.assertIn("sound", reply.alternatives[0].in_words)
        self.assertEqual(reply.alternatives[0].assumptions[0].kind, Assumption.EXCEPTION)
        dear = diagnose(DiagnoseRequest(exogenous=True, exception_weight=4))
        self.assertEqual(dear.explanations, ["break_down(red) at 0"])
        self.assertEqual(dear.alternatives[0].assumptions[0].kind, Assumption.EXOGENOUS)
        self.assertEqual(diagnose().explanations, ["init(broken(red), true)"])

    def test_tells_why_and_what_is_open(self):
        explain = service("reasoner/explain", ExplainLiteral)
        why = explain("dark", 0)
        self.assertEqual(why.status.code, Status.OK, why.status.message)
        self.assertEqual(why.proof[0].depth, 0)
        self.assertTrue(why.reasons)
        self.assertLessEqual(max(node.kind for node in why.proof), Reason.CARRIED)
        self.set_history(START[:2])
        unknown = explain("shows(d) = 2", 0)
        self.assertEqual((unknown.entailed, unknown.open), (False, True))
        self.assertEqual(unknown.values, ["1", "2", "3"])
        self.assertIn("obs(shows(d) = 2, true, 0)", unknown.deciding)
        values = service("reasoner/get_possible_values", GetPossibleValues)
        self.assertEqual(values("shows(d)", 0).values, ["1", "2", "3"])
        self.assertEqual(values("shows(e)", 0).status.code, Status.INVALID_ARGUMENT)

    def test_what_if_leaves_the_history_alone(self):
        what_if = service("reasoner/what_if", WhatIf)
        reply = what_if([happened("flip(left)", 0)], "lit(red)", 1)
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.assertEqual(
            (reply.consistent, reply.answer, reply.answer_without),
            (True, EntailsRequest.TRUE, EntailsRequest.UNKNOWN),
        )
        same_step = what_if([observed("broken(red)", True, 0)], "broken(red)", 0)
        self.assertEqual(same_step.answer, EntailsRequest.TRUE)
        self.assertEqual(same_step.answer_without, EntailsRequest.FALSE)
        clash = what_if([observed("on(left)", True, 0)], "", 0)
        self.assertFalse(clash.consistent)
        self.assertEqual(len(clash.conflict), 2)
        self.assertEqual(what_if([], "lid(red)", 0).status.code, Status.INVALID_ARGUMENT)
        self.assertTrue(service("reasoner/diagnose", Diagnose)().consistent)
        self.assertEqual(service("reasoner/add_records", AddRecords)(3, []).num_records, 3)

    def test_lists_models_retractions_and_the_program(self):
        list_models = service("reasoner/list_models", ListModels)
        reply = list_models(0)
        self.assertEqual((len(reply.models), reply.complete), (1, True))
        self.assertIn("shows(d) = 2", reply.models[0].steps[0].literals)
        self.set_history([])
        self.assertEqual((len(list_models(5).models), list_models(5).complete), (5, False))
        self.set_history([observed("on(left)", True, 0), observed("on(left)", False, 0, 0.8)])
        retractions = service("reasoner/find_retractions", FindRetractions)("on(left)", 0)
        self.assertEqual(retractions.status.code, Status.OK, retractions.status.message)
        translate = service("reasoner/translate", Translate)
        self.assertIn("#show h/3.", translate("", 0).program)
        self.assertIn("_last = _now + 2.", translate("lit(red)", 2).program)
        self.assertEqual(translate("lit(", 2).status.code, Status.INVALID_ARGUMENT)

    def test_a_progressed_history_goes_on(self):
        add_records = service("reasoner/add_records", AddRecords)
        self.assertEqual(add_records(3, [happened("flip(left)", 0)]).num_records, 4)
        reply = service("reasoner/progress_history", ProgressHistory)(1)
        self.assertEqual(reply.status.code, Status.OK, reply.status.message)
        self.assertEqual((reply.first_step, reply.num_records, reply.kept_because), (1, 0, []))
        self.assertEqual(service("reasoner/entails", Entails)("lit(red)", 1).answer, 1)
        early = add_records(4, [observed("on(left)", True, 0)])
        self.assertEqual(early.status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(add_records(4, [happened("flip(right)", 1)]).num_records, 5)
        client = actionlib.SimpleActionClient("reasoner/plan", MakePlanAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(TIMEOUT_S)))
        client.send_goal_and_wait(MakePlanGoal(goal="dark"), rospy.Duration(TIMEOUT_S))
        result = client.get_result()
        self.assertEqual(result.status.code, Status.OK, result.status.message)
        self.assertEqual(len(result.plans[0].steps), 2)

    def test_tells_what_is_relevant(self):
        find = service("reasoner/find_relevant", FindRelevant)
        part = find("lit(red)")
        self.assertEqual(part.status.code, Status.OK, part.status.message)
        self.assertNotIn("shows(d)", [item.name for item in part.fluents])
        self.assertLess(part.considered.fluents, part.whole.fluents)
        self.assertEqual(find("lit(").status.code, Status.INVALID_ARGUMENT)

    def test_plans_with_options(self):
        client = actionlib.SimpleActionClient("reasoner/plan", MakePlanAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(TIMEOUT_S)))

        def result(**goal):
            client.send_goal_and_wait(MakePlanGoal(**goal), rospy.Duration(TIMEOUT_S))
            return client.get_result()

        both = result(goal="lit(red) and lit(green)")
        self.assertEqual(both.status.code, Status.OK, both.status.message)
        self.assertEqual(len(both.plans[0].steps), 2)
        none = result(goal="lit(red) and dark")
        self.assertEqual((none.status.code, none.plans), (Status.OK, []))
        self.assertTrue(none.reason)
        for wrong in (
            {"goal": "lit(red)", "preference": 9},
            {"goal": "lit(red)", "max_plans": 4000000000},
            {"goal": "lit(red)", "time_limit": rospy.Duration(-1)},
            {"goal": "lit(red) and " * 2000 + "dark"},
            {"goal": Bytes(b"lit(\x00\xff)")},
        ):
            self.assertEqual(result(**wrong).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(result(goal="lit(red)").status.code, Status.OK)

    def test_a_goal_that_is_cancelled_ends_within_200_ms(self):
        client = actionlib.SimpleActionClient("counter/reasoner/plan", MakePlanAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(TIMEOUT_S)))
        zero = [init(f"on({bit})", False) for bit in range(14)]
        self.assertEqual(
            service("counter/reasoner/set_history", SetHistory)(zero).status.code, Status.OK
        )
        durations = []
        for horizon in (3, 8, 20):
            heard = []
            client.send_goal(
                MakePlanGoal(goal="on(13)"), feedback_cb=lambda f, h=heard: h.append(f.horizon)
            )
            deadline = time.monotonic() + TIMEOUT_S
            while not heard or heard[-1] < horizon:
                self.assertLess(time.monotonic(), deadline, "no feedback")
                time.sleep(0.005)
            start = time.monotonic()
            client.cancel_goal()
            self.assertTrue(client.wait_for_result(rospy.Duration(TIMEOUT_S)))
            durations.append(time.monotonic() - start)
            self.assertEqual(client.get_result().status.code, Status.CANCELLED)
        # A busy machine may delay one of them.
        self.assertLess(sorted(durations)[1], 0.2, durations)
        # The node goes on: a new goal is accepted and answered.
        client.send_goal_and_wait(MakePlanGoal(goal="on(0)"), rospy.Duration(TIMEOUT_S))
        result = client.get_result()
        self.assertIsInstance(result, MakePlanResult)
        self.assertEqual([s.actions for s in result.plans[0].steps], [["set(0)"]])

    def test_odd_and_oversized_requests_get_an_error_and_the_node_lives(self):
        entails = service("reasoner/entails", Entails)
        odd = [b"on(\x00left)", b"on(\xff\xfe)", b"on(left)\x00", "lit(\u00e9)".encode(), b""]
        odd += [b"(" * 4000, b"-" * 4000, b"not " * 1000 + b"dark", b"x" * 2_000_000]
        for raw in odd:
            reply = entails(Bytes(raw), 0)
            self.assertEqual(reply.status.code, Status.INVALID_ARGUMENT, raw[:20])
            self.assertTrue(reply.status.message)
        add_records = service("reasoner/add_records", AddRecords)
        for raw in odd:
            reply = add_records(3, [init(Bytes(raw), True)])
            self.assertEqual(reply.status.code, Status.INVALID_ARGUMENT, raw[:20])
            self.assertEqual(reply.num_records, 3)
        self.assertEqual(add_records(3, [happened("flip(left)", 4000000000)]).num_records, 3)
        many = self.set_history(START * 500)
        self.assertEqual(many.status.code, Status.RESOURCE_EXHAUSTED)
        self.assertEqual(many.num_records, 3)
        kind = init("dark", True)
        kind.kind = 77
        self.assertEqual(add_records(3, [kind]).status.code, Status.INVALID_ARGUMENT)
        unsure = observed("dark", True, 0, confidence=float("nan"))
        self.assertEqual(add_records(3, [unsure]).status.code, Status.INVALID_ARGUMENT)
        self.assertEqual(entails("dark", 0).answer, EntailsRequest.TRUE)

    def test_a_client_notices_a_restart_and_tells_the_history_again(self):
        rosnode.kill_nodes(["/reasoner_node"])
        deadline = time.monotonic() + TIMEOUT_S
        reply = None
        while reply is None or reply.num_records > 0:
            self.assertLess(time.monotonic(), deadline, "the node did not come back")
            try:
                reply = service("reasoner/add_records", AddRecords)(3, [])
            except (rospy.ServiceException, rospy.ROSException):
                time.sleep(0.1)
        self.assertEqual(reply.status.code, Status.FAILED_PRECONDITION)
        self.assertIn("set the history again", reply.status.message)
        self.assertEqual(service("reasoner/set_history", SetHistory)(START).num_records, 3)
        again = service("reasoner/entails", Entails)("dark", 0)
        self.assertEqual(again.answer, EntailsRequest.TRUE)

    def test_diagnostics_tell_records_and_the_last_question(self):
        service("reasoner/entails", Entails)("dark", 0)
        told = diagnostics()
        while told["last question"] != "entails":
            told = diagnostics()
        self.assertEqual(told["records"], "3")
        self.assertGreaterEqual(int(told["questions answered"]), 2)
        self.assertLess(float(told["time since last question (s)"]), TIMEOUT_S)
        self.assertGreater(float(told["last question took (s)"]), 0.0)

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

    def test_reloads_its_domain_or_changes_nothing(self):
        with tempfile.TemporaryDirectory() as folder, started_node(folder) as domain:
            reload_domain = service("reloaded/reasoner/reload_domain", ReloadDomain)
            set_history = service("reloaded/reasoner/set_history", SetHistory)
            entails = service("reloaded/reasoner/entails", Entails)
            self.assertEqual(set_history([init("on(left)", True)]).num_records, 1)
            self.assertEqual(entails("on(right)", 0).answer, EntailsRequest.UNKNOWN)

            text = domain.read_text(encoding="utf-8")
            domain.write_text(text + "defaults\n  off(S): -on(S).\n", encoding="utf-8")
            reply = reload_domain()
            self.assertEqual(reply.status.code, Status.OK, reply.status.message)
            self.assertEqual(entails("on(right)", 0).answer, EntailsRequest.FALSE)
            self.assertEqual(entails("on(left)", 0).answer, EntailsRequest.TRUE)
            self.assertEqual(diagnostics("/reloaded/reasoner_node: reasoner")["records"], "1")

            domain.write_text(text + "axioms\n  push(S) causes on(S).\n  dark if .\n")
            lines = text.count("\n")
            reply = reload_domain()
            self.assertEqual(reply.status.code, Status.INVALID_ARGUMENT)
            self.assertIn(f"{domain}:{lines + 2}:3: ", reply.status.message)
            self.assertIn(f"{domain}:{lines + 3}:", reply.status.message)
            self.assertEqual(entails("on(right)", 0).answer, EntailsRequest.FALSE)

            domain.write_text(text.replace("left", "middle"), encoding="utf-8")
            reply = reload_domain()
            self.assertEqual(reply.status.code, Status.INVALID_ARGUMENT)
            self.assertIn("record 1 of the history", reply.status.message)
            self.assertIn("left", reply.status.message)
            domain.unlink()
            self.assertEqual(reload_domain().status.code, Status.NOT_FOUND)
            self.assertEqual(entails("on(left)", 0).answer, EntailsRequest.TRUE)

            domain.write_text(text.replace("on(", "up("), encoding="utf-8")
            self.assertEqual(set_history([]).status.code, Status.OK)
            self.assertEqual(reload_domain().status.code, Status.OK)
            client = actionlib.SimpleActionClient("reloaded/reasoner/plan", MakePlanAction)
            self.assertTrue(client.wait_for_server(rospy.Duration(TIMEOUT_S)))
            client.send_goal_and_wait(MakePlanGoal(goal="up(left)"), rospy.Duration(TIMEOUT_S))
            self.assertEqual(client.get_result().status.code, Status.OK)

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
