"""`./kr3 goal`: give the running robot a goal and follow the mission to its end."""
import argparse

from kr3_msgs.msg import Status

from kr3_experiments.bringup import new_run_dir, running_master
from kr3_experiments.mission import EventFollower, achieve
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "formula", help='over literals of the domain, such as "f(x) = a and not g(x)"'
    )
    parser.add_argument(
        "--master", metavar="URI", help="the robot's ROS master (default: that of ./kr3 up)"
    )
    parser.add_argument(
        "--time-limit", type=float, metavar="S", help="wall time, s (default: none)"
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 only if the robot is sure to have reached the goal; Ctrl-C cancels the mission"""
    terminal = Terminal()
    uri = running_master(args.master, terminal.detail)
    with Stack(new_run_dir("goal"), terminal.detail) as stack:
        stack.use_master(uri)
        follower = EventFollower(terminal.event)
        result = achieve(stack, args.formula, args.time_limit)
        stack.spin_until(follower.has_ended, 1.0)
    if result.status.code != Status.OK:
        terminal.verdict(False, f"refused: {result.status.message}")
        return 1
    word = "achieved" if result.achieved else "not achieved"
    counts = f"{result.hl_actions} high-level and {result.ll_actions} low-level actions, {result.duration_s:.0f} s"
    terminal.verdict(result.achieved, f"{word}: {result.reason} ({counts})")
    return 0 if result.achieved else 1
