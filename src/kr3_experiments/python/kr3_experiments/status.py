"""`./kr3 status`: what the running robot is doing, and how its nodes are."""
import argparse
import os
import time
from typing import Any, Dict, List, Optional, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from kr3_msgs.msg import MissionState, SimulationState

from kr3_experiments.bringup import running_master
from kr3_experiments.terminal import Terminal

_STATES = {
    MissionState.IDLE: "idle",
    MissionState.ACTIVE: "active",
    MissionState.SUCCEEDED: "succeeded",
    MissionState.FAILED: "failed",
    MissionState.CANCELLED: "cancelled",
}
_LEVELS = {
    DiagnosticStatus.OK: "ok",
    DiagnosticStatus.WARN: "WARN",
    DiagnosticStatus.ERROR: "ERROR",
    DiagnosticStatus.STALE: "stale",
}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--master", metavar="URI", help="the robot's ROS master (default: that of ./kr3 up)"
    )
    parser.add_argument(
        "--wait", type=float, default=2.0, metavar="S", help="how long to listen, s (default: 2)"
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 when the executive answers"""
    terminal = Terminal()
    os.environ["ROS_MASTER_URI"] = running_master(args.master, terminal.detail)
    rospy.init_node("kr3_status", anonymous=True, disable_signals=True)
    mission: List[MissionState] = []
    simulation: List[SimulationState] = []
    diagnostics: Dict[str, DiagnosticStatus] = {}

    def on_diagnostics(message: DiagnosticArray) -> None:
        diagnostics.update({status.name: status for status in message.status})

    subscribers: List[Any] = [
        rospy.Subscriber("executive/state", MissionState, mission.append),
        rospy.Subscriber("simulation/state", SimulationState, simulation.append),
        rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics),
    ]
    time.sleep(args.wait)  # listening is the work here
    for subscriber in subscribers:
        subscriber.unregister()
    rospy.signal_shutdown("done")
    for line in mission_lines(mission[-1] if mission else None):
        terminal.line(line)
    if simulation:
        state = simulation[-1]
        word = "paused" if state.paused else f"{state.real_time_factor:.1f} times real time"
        terminal.line(f"simulator   {word}, {state.robot_contacts} contacts of the robot")
    for name, level, text in diagnostic_rows(diagnostics):
        terminal.line(f"{level:<11} {name}: {text}")
    return 0 if mission else 1


def mission_lines(state: Optional[MissionState]) -> List[str]:
    """The mission in words."""
    if state is None:
        return ["mission     unknown: executive/state says nothing"]
    lines = [f"mission     {_STATES.get(state.state, state.state)}"]
    if state.goal:
        lines.append(f"goal        {state.goal}")
    for index, step in enumerate(state.plan.steps):
        marker = ">" if index == state.plan_index else " "
        lines.append(f"plan      {marker} {', '.join(step.actions)}")
    if state.plan.hypothesis:
        lines.append(f"assuming    {', '.join(state.plan.hypothesis)}")
    if state.ll_action and state.state == MissionState.ACTIVE:
        lines.append(f"doing       {state.ll_action}")
    lines += [f"exception   {text}" for text in state.exceptions]
    if state.goal:
        lines.append(
            f"done        {state.hl_actions_done} high-level, {state.ll_actions_done} low-level actions"
        )
    return lines


def diagnostic_rows(diagnostics: Dict[str, DiagnosticStatus]) -> List[Tuple[str, str, str]]:
    """Name, level and message, sorted by name."""
    return [
        (name, _LEVELS.get(status.level, str(status.level)), status.message)
        for name, status in sorted(diagnostics.items())
    ]
