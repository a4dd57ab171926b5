"""The robot of a running stack as a trainee: skills are done, and the truth comes from the simulator."""
import threading
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Tuple

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from kr3_msgs.msg import CellArray, ExecuteSkillAction, ExecuteSkillGoal, ModelStates, Status
from nav_msgs.msg import Odometry

from kr3_experiments.errors import Kr3Error, StackError
from kr3_experiments.learning.bindings import Binding
from kr3_experiments.learning.laws import GroundAction, State, Value
from kr3_experiments.learning.models_file import action_name
from kr3_experiments.learning.trials import Outcome
from kr3_experiments.learning.truth import CellArea, Snapshot, Truth
from kr3_experiments.stack import Stack

_ANSWER_S = 15.0  # wall time for a server or the truth to appear
_SKILL_S = 300.0  # wall time for a skill
_CANCEL_S = 3.0
MODELS = Path("models.yaml")


def cells_of(message: CellArray) -> List[CellArea]:
    """The navigator's cells."""
    return [
        CellArea(cell.name, cell.room, (cell.center.x, cell.center.y), (cell.size_x, cell.size_y))
        for cell in message.cells
    ]


def snapshot_of(models: ModelStates, pose: Odometry, robot: str) -> Snapshot:
    """What the simulator says."""
    positions = {
        model.name: (model.pose.position.x, model.pose.position.y) for model in models.models
    }
    base = pose.pose.pose.position
    positions[robot] = (base.x, base.y)
    if models.held:
        positions[models.held] = positions[robot]
    return Snapshot(positions, models.held)


class Distances:
    """Metres that an action drives, where the models let its cost depend on them."""

    def __init__(self, models: Mapping[str, Mapping[str, Any]], keys: Mapping[str, str]):
        """@param models  entries by action name; @param keys  "name(P, Q)" by action name"""
        self._parts: Dict[str, Tuple[str, List[str], int]] = {}
        for name, entry in models.items():
            distance = (entry.get("cost") or {}).get("distance")
            if distance is None:
                continue
            _, parameters = action_name(keys[name], MODELS)
            fluent, arguments = action_name(str(distance["from"]), MODELS)
            self._parts[name] = (
                fluent,
                [str(parameters.index(item)) if item in parameters else item for item in arguments],
                parameters.index(distance["to"]),
            )

    def metres(self, action: GroundAction, state: State, message: CellArray) -> Optional[float]:
        """None: the cost of this action does not depend on a distance, or it is not known."""
        if action.name not in self._parts:
            return None
        fluent, arguments, to = self._parts[action.name]
        values = [action.arguments[int(item)] if item.isdigit() else item for item in arguments]
        start = state.get(f"{fluent}({', '.join(values)})")
        names = [cell.name for cell in message.cells]
        if start not in names or action.arguments[to] not in names:
            return None
        index = names.index(str(start)) * len(names) + names.index(action.arguments[to])
        return float(message.travel_distance[index])


class Robot:
    """Does skills, one at a time, on a running stack. Main thread only."""

    def __init__(
        self,
        stack: Stack,
        truth: Truth,
        bindings: Mapping[str, Binding],
        distances: Distances,
    ):
        """@throws StackError  no cells, no ground truth, or a skill's server does not answer"""
        self._stack = stack
        self._truth = truth
        self._bindings = bindings
        self._distances = distances
        self._cells: Any = None  # kr3_msgs/CellArray
        self._models: Any = None  # kr3_msgs/ModelStates
        self._pose: Any = None  # nav_msgs/Odometry
        self._subscribers = [
            rospy.Subscriber("cells", CellArray, self._on_cells),
            rospy.Subscriber("ground_truth/models", ModelStates, self._on_models),
            rospy.Subscriber("ground_truth/pose", Odometry, self._on_pose),
        ]
        self._clients: Dict[str, actionlib.ActionClient] = {}
        if not stack.spin_until(
            lambda: None not in (self._cells, self._models, self._pose), _ANSWER_S
        ):
            raise StackError("cells or ground truth did not arrive")

    @property
    def cells(self) -> List[CellArea]:
        """The low level's places."""
        return cells_of(self._cells)

    def truth(self) -> Dict[str, Value]:
        """The state now: newer than everything that was done. @throws StackError  the simulator does not say it"""
        now = rospy.get_rostime()

        def fresh() -> bool:
            return self._models.header.stamp >= now and self._pose.header.stamp >= now

        if not self._stack.spin_until(fresh, _ANSWER_S):
            raise StackError("the simulator's ground truth did not arrive")
        return self._truth.state(
            snapshot_of(self._models, self._pose, self._truth.robot), self.cells
        )

    def execute(self, action: GroundAction, state: State) -> Outcome:
        """Do an action by its skill. @throws Kr3Error  the skill refused it; StackError  no answer"""
        binding = self._bindings[action.name]
        client = self._client(binding.server)
        finished = threading.Event()

        def on_transition(goal: actionlib.ClientGoalHandle) -> None:
            if goal.get_comm_state() == actionlib.CommState.DONE:
                finished.set()

        goal = ExecuteSkillGoal(
            skill=binding.skill, arguments=binding.skill_arguments(action, state)
        )
        handle = client.send_goal(goal, on_transition)
        try:
            in_time = self._stack.spin_until(finished.is_set, _SKILL_S)
        except BaseException:
            handle.cancel()
            finished.wait(_CANCEL_S)
            raise
        if not in_time:
            handle.cancel()
            finished.wait(_CANCEL_S)
            raise StackError(f"{action} did not end within {_SKILL_S:.0f} s of wall time")
        result = handle.get_result()
        if result is None:
            ended = GoalStatus.to_string(handle.get_terminal_state())
            raise Kr3Error(f"{action} ended without a result ({ended})")
        if result.status.code != Status.OK:
            raise Kr3Error(f"{action}: {result.status.message}")
        return Outcome(
            result.outcome,
            tuple(result.observation),
            result.duration_s,
            self._distances.metres(action, state, self._cells),
        )

    def _client(self, server: str) -> actionlib.ActionClient:
        if server not in self._clients:
            client = actionlib.ActionClient(server, ExecuteSkillAction)
            connected = threading.Event()

            def connect() -> None:
                if client.wait_for_server():
                    connected.set()

            threading.Thread(target=connect, daemon=True).start()
            if not self._stack.spin_until(connected.is_set, _ANSWER_S):
                raise StackError(f"{server} does not answer")
            self._clients[server] = client
        return self._clients[server]

    def _on_cells(self, message: CellArray) -> None:
        self._cells = message

    def _on_models(self, message: ModelStates) -> None:
        self._models = message

    def _on_pose(self, message: Odometry) -> None:
        self._pose = message
