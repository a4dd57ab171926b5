"""`./kr3 record`: record a bag of the running robot."""
import argparse
from pathlib import Path

from kr3_experiments.bringup import new_run_dir, running_master
from kr3_experiments.cli import Interrupted
from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.mission import LookCollector
from kr3_experiments.recorder import load_profile, start_recording
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--profile", type=Path, help="list of topics (default: rosbag/mission.yaml)"
    )
    parser.add_argument(
        "--master", metavar="URI", help="the robot's ROS master (default: that of ./kr3 up)"
    )
    parser.add_argument(
        "--duration", type=float, metavar="S", help="wall time, s (default: until Ctrl-C)"
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 when the bag was closed properly"""
    terminal = Terminal()
    profile = load_profile(args.profile or repository_root() / "rosbag" / "mission.yaml")
    uri = running_master(args.master, terminal.detail)
    run_dir = new_run_dir("record")
    with Stack(run_dir, terminal.detail) as stack:
        stack.use_master(uri)
        looks = LookCollector()
        recorder = start_recording(stack, profile, run_dir / "mission.bag")
        terminal.heading(f"Recording {len(profile.topics)} topics; Ctrl-C ends it")
        try:
            stack.spin_until(lambda: not recorder.is_recording(), args.duration)
        except Interrupted:
            pass  # the usual way to end a recording
        finally:
            ended_early = not recorder.is_recording()
            looks.close()
            bag = recorder.stop(complete=not ended_early)
    if bag is None or ended_early:
        raise Kr3Error(
            f"the recording ended early, the bag is partial: {bag or 'no file'} (see {run_dir}/log)"
        )
    terminal.verdict(True, f"bag: {bag} ({bag.stat().st_size / 1e6:.1f} MB)")
    return 0
