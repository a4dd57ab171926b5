"""`./kr3 demo`: the whole mission on the whole stack, judged by the simulator's ground truth, with bag and report."""
import argparse
import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Optional

import numpy as np
import rospy
from kr3_msgs.msg import AchieveResult, Status

from kr3_experiments.bringup import (
    METHODS,
    STATE_FILE,
    RunNote,
    World,
    add_world_options,
    choose_port,
    existing_run_dir,
    new_run_dir,
    start_stack,
    world_from,
)
from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error, StackError
from kr3_experiments.events import write_events
from kr3_experiments.ground_truth import Verdict, check_fetched
from kr3_experiments.mission import EventFollower, LookCollector, WorldCollector, achieve
from kr3_experiments.recorder import Recorder, load_profile, require_space, start_recording
from kr3_experiments.report import GridMap, MissionRecord, write_report
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal
from kr3_experiments.variant import with_goal_place


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    add_world_options(parser)
    parser.add_argument("--goal", help="another goal than the scenario's")
    parser.add_argument(
        "--bring-to", metavar="PLACE", help="the scenario's goal, but with the object wanted here"
    )
    parser.add_argument(
        "--run-dir",
        type=Path,
        metavar="DIR",
        help="where the results go (default: a new one in runs/)",
    )
    parser.add_argument("--no-bag", action="store_true", help="record nothing")
    parser.add_argument(
        "--time-limit",
        type=float,
        default=600.0,
        metavar="S",
        help="wall time for the mission, s (default: 600)",
    )
    parser.add_argument(
        "--mission-limit",
        type=float,
        default=0.0,
        metavar="S",
        help="simulated time for the mission, s: then it fails (default: none)",
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 only if the object is where the goal wants it, in the simulator's ground truth"""
    terminal = Terminal()
    if args.mission_limit < 0.0:
        raise Kr3Error(f"--mission-limit {args.mission_limit}: expected a number >= 0")
    if args.goal is not None and args.bring_to is not None:
        raise Kr3Error("--goal and --bring-to: expected one of them")
    world = world_from(args)
    if args.bring_to is not None:
        world = replace(world, domain=with_goal_place(world.domain, args.bring_to))
    world.domain.require_map()
    if args.stack is None:  # another stack may do without a detector
        world.domain.require_model()
    profile = None if args.no_bag else load_profile(repository_root() / "rosbag" / "mission.yaml")
    run_dir = new_run_dir("demo") if args.run_dir is None else _fresh_run_dir(args.run_dir)
    if profile is not None:
        require_space(run_dir, profile.min_free_mb)
    goal = args.goal or world.domain.goal
    by = "" if world.method == METHODS[0] else f", method {world.method}"
    terminal.heading(f"KR3 demo: domain {world.domain.name}, seed {world.seed}{by}")
    terminal.detail(f"goal: {goal}")
    terminal.detail(
        f"in truth {world.domain.target.object} is in {world.target_at}"
        f" (the robot {'is told' if world.told else 'does not know'})"
    )
    terminal.heading("Starting the stack")
    started = time.monotonic()
    with Stack(run_dir, terminal.detail) as stack:
        stack.start_master(choose_port(args.port))
        with RunNote(stack.uri, run_dir):
            start_stack(stack, world, run_dir, args.stack)
            observers = Observers(terminal)
            recorder = (
                None
                if profile is None
                else start_recording(stack, profile, run_dir / "mission.bag")
            )
            start_s = time.monotonic() - started
            terminal.heading(f"Mission (stack started in {start_s:.1f} s)")
            complete = False
            try:
                mission = run_mission(stack, goal, args.time_limit, observers, args.mission_limit)
                complete = True
            finally:
                _close_bag(recorder, complete, terminal)
            verdict = mission_verdict(stack, world, mission.result, observers, args.goal is None)
    return _conclude(terminal, world, goal, run_dir, mission, verdict, observers, start_s, recorder)


def _fresh_run_dir(folder: Path) -> Path:
    """@throws Kr3Error  it cannot be written, or holds an earlier mission, which the robot would go on with"""
    folder = existing_run_dir(folder)
    left = folder / STATE_FILE
    if left.exists():
        raise Kr3Error(
            f"--run-dir {folder} holds an earlier mission ({left.name}): expected another folder"
        )
    return folder


class Observers:
    """Everything that listens during a mission."""

    def __init__(self, terminal: Terminal):
        self.follower = EventFollower(terminal.event)
        self.looks = LookCollector()
        self.world = WorldCollector()


class Mission:
    """Result and times of a mission that came to its end."""

    def __init__(self, result: AchieveResult, wall_s: float, simulated_s: float):
        self.result = result
        self.wall_s = wall_s
        self.simulated_s = simulated_s


def run_mission(
    stack: Stack,
    goal: str,
    wall_limit_s: float,
    observers: Observers,
    simulated_limit_s: float = 0.0,
) -> Mission:
    """Send the goal and wait for its result and last event.

    @param simulated_limit_s  after which the executive ends the mission; 0: none
    @throws StackError  no result, or not in `wall_limit_s`
    """
    wall = time.monotonic()
    simulated = rospy.get_time()
    result = achieve(stack, goal, wall_limit_s, simulated_limit_s)
    stack.spin_until(observers.follower.has_ended, 3.0)
    return Mission(result, time.monotonic() - wall, rospy.get_time() - simulated)


def mission_verdict(
    stack: Stack, world: World, result: AchieveResult, observers: Observers, own_goal: bool
) -> Verdict:
    """Success needs both: the robot says that it is done, and the ground truth agrees.

    @param own_goal  False: the goal was given by hand, so there is nothing to compare the ground truth with
    """
    if result.status.code != Status.OK:
        return Verdict(False, f"the mission ended with an error: {result.status.message}")
    if not result.achieved:
        return Verdict(False, f"the robot gave up: {result.reason}")
    if not own_goal:
        return Verdict(True, f"the robot says so: {result.reason}")
    stamp = rospy.get_rostime()

    def is_fresh() -> bool:
        models = observers.world.models
        return models is not None and models.header.stamp >= stamp

    fresh = stack.spin_until(is_fresh, 10.0)
    models = observers.world.models
    if not fresh or models is None:
        raise StackError("the simulator's ground truth did not arrive")
    positions = {
        model.name: (model.pose.position.x, model.pose.position.y, model.pose.position.z)
        for model in models.models
    }
    return check_fetched(world.domain, positions, models.held)


def _close_bag(recorder: Optional[Recorder], complete: bool, terminal: Terminal) -> None:
    if recorder is None:
        return
    bag = recorder.stop(complete)
    if bag is None:
        terminal.verdict(False, "there is no bag: the recorder ended early (see log/recorder.log)")
    elif not complete:
        terminal.verdict(False, f"the bag is partial, the mission did not end: {bag}")


def _conclude(
    terminal: Terminal,
    world: World,
    goal: str,
    run_dir: Path,
    mission: Mission,
    verdict: Verdict,
    observers: Observers,
    start_s: float,
    recorder: Optional[Recorder],
) -> int:
    result = mission.result
    figures: Dict[str, Any] = {
        "seed": world.seed,
        "target_at": world.target_at,
        "goal_place": world.domain.target.goal_place,
        "method": world.method,
        "high_level_actions": result.hl_actions,
        "low_level_actions": result.ll_actions,
        "stack_start_s": start_s,
        "mission_wall_s": mission.wall_s,
        "mission_simulated_s": mission.simulated_s,
        "real_time_factor": mission.simulated_s / max(mission.wall_s, 1e-9),
        "robot_contacts": observers.world.contacts,
    }
    picture = observers.looks.found_image
    record = MissionRecord(
        title=f"KR3 mission in the {world.domain.name}",
        goal=goal,
        success=verdict.success,
        reason=verdict.reason,
        figures=figures,
        events=observers.follower.events,
        places=world.domain.places,
        trajectory=observers.world.trajectory,
        grid=_grid(observers),
        found_image=None if picture is None else np.ascontiguousarray(picture[:, :, ::-1]),
        found_what=observers.looks.found_what,
    )
    write_report(record, run_dir / "report.html")
    write_events(observers.follower.events, run_dir / "events.jsonl")
    summary = {
        "success": verdict.success,
        "declared": bool(result.achieved),
        "reason": verdict.reason,
        "goal": goal,
        **figures,
    }
    (run_dir / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    terminal.heading("Result")
    for name, value in figures.items():
        shown = f"{value:.2f}" if isinstance(value, float) else str(value)
        terminal.detail(f"{name.replace('_', ' '):<22} {shown}")
    terminal.detail(f"{'report':<22} {run_dir / 'report.html'}")
    if recorder is not None and recorder.bag.exists():
        terminal.detail(f"{'bag':<22} {recorder.bag} ({recorder.bag.stat().st_size / 1e6:.1f} MB)")
    terminal.verdict(
        verdict.success, f"{'SUCCESS' if verdict.success else 'FAILURE'}: {verdict.reason}"
    )
    return 0 if verdict.success else 1


def _grid(observers: Observers) -> Optional[GridMap]:
    message = observers.world.map
    if message is None:
        return None
    info = message.info
    if info.height * info.width != len(message.data):
        raise Kr3Error(
            f"the map has {len(message.data)} cells, expected {info.height} x {info.width}"
        )
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)
    return GridMap(cells, info.resolution, info.origin.position.x, info.origin.position.y)
