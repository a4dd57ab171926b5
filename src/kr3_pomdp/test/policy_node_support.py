"""What the tests of policy_node share: models, and clients that name their fields."""
import threading

import actionlib
import rospy
from actionlib import CommState
from kr3_msgs import srv
from kr3_msgs.msg import SolveAction, SolveGoal, Status

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

# A switch that the robot sees, and a lamp behind it that it does not.
SWITCH_POMDPX = """<?xml version="1.0"?>
<pomdpx version="0.1"><Discount>0.9</Discount>
<Variable>
<StateVar vnamePrev="switch_0" vnameCurr="switch_1" fullyObs="true"><ValueEnum>on off</ValueEnum></StateVar>
<StateVar vnamePrev="lamp_0" vnameCurr="lamp_1" fullyObs="false"><ValueEnum>good bad</ValueEnum></StateVar>
<ObsVar vname="light"><ValueEnum>yes no</ValueEnum></ObsVar>
<ActionVar vname="act"><ValueEnum>toggle wait</ValueEnum></ActionVar>
<RewardVar vname="earned"/>
</Variable>
<InitialStateBelief>
<CondProb><Var>switch_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>uniform</ProbTable></Entry></Parameter></CondProb>
<CondProb><Var>lamp_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>0.7 0.3</ProbTable></Entry></Parameter></CondProb>
</InitialStateBelief>
<StateTransitionFunction>
<CondProb><Var>switch_1</Var><Parent>act switch_0</Parent><Parameter type="TBL">
<Entry><Instance>toggle on -</Instance><ProbTable>0 1</ProbTable></Entry>
<Entry><Instance>toggle off -</Instance><ProbTable>1 0</ProbTable></Entry>
<Entry><Instance>wait - -</Instance><ProbTable>identity</ProbTable></Entry></Parameter></CondProb>
<CondProb><Var>lamp_1</Var><Parent>lamp_0</Parent><Parameter type="TBL">
<Entry><Instance>- -</Instance><ProbTable>identity</ProbTable></Entry></Parameter></CondProb>
</StateTransitionFunction>
<ObsFunction>
<CondProb><Var>light</Var><Parent>switch_1 lamp_1</Parent><Parameter type="TBL">
<Entry><Instance>* * -</Instance><ProbTable>0.1 0.9</ProbTable></Entry>
<Entry><Instance>on good -</Instance><ProbTable>0.9 0.1</ProbTable></Entry></Parameter></CondProb>
</ObsFunction>
<RewardFunction>
<Func><Var>earned</Var><Parent>act switch_0</Parent><Parameter type="TBL">
<Entry><Instance>wait on</Instance><ValueTable>1</ValueTable></Entry>
<Entry><Instance>toggle *</Instance><ValueTable>-1</ValueTable></Entry></Parameter></Func>
</RewardFunction>
</pomdpx>
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


def uniform(states: int, actions: int) -> str:
    """A short text of a model with many entries, which is long in reading."""
    return (
        f"discount: 0.9\nvalues: reward\nstates: {states}\nactions: {actions}\nobservations: 2\n"
        "T: * uniform\nO: * uniform\nR: 0 : * : * : * 1\n"
    )


class Services:
    """A function for each service of the node: `services.get_action(policy_id=..., belief=...)`."""

    TYPES = {
        "get_action": srv.GetPolicyAction,
        "update_belief": srv.UpdateBelief,
        "list_policies": srv.ListPolicies,
        "get_policy_info": srv.GetPolicyInfo,
        "release_policy": srv.ReleasePolicy,
        "save_policy": srv.SavePolicy,
        "load_policy": srv.LoadPolicy,
        "create_belief": srv.CreateBelief,
        "advance_belief": srv.AdvanceBelief,
        "get_belief": srv.GetBelief,
        "reset_belief": srv.ResetBelief,
        "delete_belief": srv.DeleteBelief,
        "list_beliefs": srv.ListBeliefs,
        "plan_online": srv.PlanOnline,
    }

    def __init__(self, namespace: str = ""):
        self._proxies = {}
        for name, kind in self.TYPES.items():
            rospy.wait_for_service(f"{namespace}pomdp/{name}", timeout=20)
            self._proxies[name] = rospy.ServiceProxy(f"{namespace}pomdp/{name}", kind)

    def __getattr__(self, name):
        proxy = self._proxies[name]
        return lambda **fields: proxy(proxy.request_class(**fields))


class Goal:
    """A goal of pomdp/solve with a client of its own, so that several run at the same time."""

    def __init__(self, namespace: str = "", **fields):
        # Not actionlib's simple client: in Python it loses an answer that comes before it has noted the goal.
        self.client = actionlib.ActionClient(f"{namespace}pomdp/solve", SolveAction)
        if not self.client.wait_for_server(rospy.Duration(20)):
            raise RuntimeError("pomdp/solve did not come up")
        self.feedback = []
        self._done = None  # the handle of the goal, once it has ended
        self._changed = threading.Condition()
        self._handle = self.client.send_goal(
            SolveGoal(**fields), self._on_transition, self._on_feedback
        )

    def _on_transition(self, handle):
        with self._changed:
            if handle.get_comm_state() == CommState.DONE:
                self._done = handle
                self._changed.notify_all()

    def _on_feedback(self, _handle, feedback):
        with self._changed:
            self.feedback.append(feedback)
            self._changed.notify_all()

    def wait_for_phase(self, phase: int, count: int = 1, timeout: float = 20.0):
        """The last feedback, once there are `count` of this phase."""
        with self._changed:
            if not self._changed.wait_for(
                lambda: sum(f.phase == phase for f in self.feedback) >= count, timeout
            ):
                raise RuntimeError(f"no {count} feedbacks of phase {phase}: {self.feedback}")
            return self.feedback[-1]

    def cancel(self):
        self._handle.cancel()

    def result(self, timeout: float = 40.0):
        with self._changed:
            if not self._changed.wait_for(lambda: self._done, timeout):
                raise RuntimeError("no result in time")
            return self._done.get_result()

    def state(self) -> int:
        return self._handle.get_goal_status()


def solved(**fields) -> str:
    """The id of a policy; Tiger unless told otherwise."""
    result = Goal(**{"model": TIGER, **fields}).result()
    if result.status.code != Status.OK:
        raise RuntimeError(result.status.message)
    return result.policy_id
