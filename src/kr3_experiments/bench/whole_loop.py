#!/usr/bin/python3
"""The loop part of ./kr3 bench robot: simulator and navigation as ROS nodes, without and with camera and detector.

Run as a program it measures one of them, in a process of its own because a process can join one ROS master only:
whole_loop.py [--detector] [--drives N] [--seed N] prints the figures as JSON. The simulation is as fast as it can be
while it waits for the answers: a pose for every scan, and with --detector detections for an image every 0.2 s.
"""

import argparse
import json
import pathlib
import re
import sys
import tempfile
import threading
import typing

import yaml

if typing.TYPE_CHECKING:
    from bench_robot import Bench

ROOT = pathlib.Path(__file__).resolve().parents[3]
DOMAIN = "office"
LIMIT_S = 600.0  # wall time
SUMMARY = re.compile(r"(\d+) of (\d+) reached, (\d+) s simulated in ([0-9.]+) s, factor ([0-9.]+)")


def measure(bench: "Bench") -> None:
    """Both loops, one after the other."""
    for name, goal, flags in (
        ("whole loop without camera, ROS (wall)", 20.0, []),
        ("whole loop, camera 320x240 10 Hz, detection 5 Hz (wall)", 5.0, ["--detector"]),
    ):
        command = [sys.executable, "-B", str(pathlib.Path(__file__)), "--seed", str(bench.seed)]
        command += [*flags, *(["--drives", "6"] if bench.quick else [])]
        figures = json.loads(bench.run(command, 2 * LIMIT_S).splitlines()[-1])
        bench.add(name, figures.pop("factor"), "x", goal=goal, better="higher", params=figures)


def one_loop(work: pathlib.Path, detector: bool, drives: int, seed: int) -> dict:
    """Start the nodes, let the robot drive. @return factor, drives, and what was answered a simulated second"""
    # Only here: the bench's other parts need no ROS.
    import rospy
    from kr3_experiments.bringup import package_config, start_followers
    from kr3_experiments.errors import Kr3Error
    from kr3_experiments.master import free_port
    from kr3_experiments.stack import Stack
    from kr3_experiments.stack_file import load_stack

    folder = ROOT / "domains" / DOMAIN
    building = yaml.safe_load((folder / "building.yaml").read_text(encoding="utf-8"))
    variables = {
        "domain_dir": str(folder),
        "run_dir": str(work),
        "seed": seed,
        "robot_start": building["robot"]["start"],
    }
    specs = load_stack(
        package_config("loop_stack.yaml"),
        variables,
        lockstep=True,
        leave_out=() if detector else ("detector_node",),
    )
    counts = {spec.follow.topic: 0 for spec in specs if spec.follow}
    lock = threading.Lock()

    def count(_message: object, topic: str) -> None:
        with lock:
            counts[topic] += 1

    with Stack(work, lambda line: print(line, file=sys.stderr)) as stack:
        stack.start_master(free_port())
        start_followers(stack, specs)
        for topic in counts:
            rospy.Subscriber(topic, rospy.AnyMsg, count, topic, queue_size=100)
        stack.start_nodes(specs)
        check = ["rosrun", "kr3_navigation", "drive_check"]
        check += ["--first", str(drives)] if drives else []
        driving = stack.start_unwatched("drive_check", check)
        if not stack.spin_until(lambda: driving.exit_code() is not None, LIMIT_S):
            raise Kr3Error(f"the drives were not done within {LIMIT_S:g} s")
        text = driving.log_tail(60)
        elapsed_s = rospy.get_time()
    found = SUMMARY.search(text)
    if not found:
        raise Kr3Error(f"drive_check said:\n{text}")
    reached, wanted, simulated_s, wall_s, factor = (float(value) for value in found.groups())
    return {
        "factor": factor,
        "drives": int(wanted),
        "reached": int(reached),
        "simulated_s": simulated_s,
        "wall_s": wall_s,
        **{f"{topic}_per_simulated_s": number / elapsed_s for topic, number in counts.items()},
    }


def main() -> int:
    """@return 0 when it could be measured"""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--detector", action="store_true", help="with camera and detector")
    parser.add_argument("--drives", type=int, default=0, help="default: to every cell")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    from kr3_experiments.errors import Kr3Error

    with tempfile.TemporaryDirectory() as work:
        try:
            print(json.dumps(one_loop(pathlib.Path(work), args.detector, args.drives, args.seed)))
        except Kr3Error as error:
            print(f"whole_loop: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
