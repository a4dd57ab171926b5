"""`./kr3 replay`: compute a bag's missions again, or play its topics, or tell its events."""
import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Iterator, List, Tuple

from kr3_experiments.bringup import DEFAULT_PORT, choose_port, new_run_dir
from kr3_experiments.errors import Kr3Error
from kr3_experiments.events import Event, event_from_message
from kr3_experiments.mission_inputs import input_lines, open_bag
from kr3_experiments.programs import find_program
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal

_EVENTS = ("executive/events", "/executive/events")
UNUSABLE = 2  # exit code: nothing can be computed from the bag


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("bag", type=Path)
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--check", action="store_true", help="print the verdict and the first difference only"
    )
    what.add_argument(
        "--events-only", action="store_true", help="tell what the mission's events said, at once"
    )
    what.add_argument(
        "--rate", type=float, metavar="X", help="play the topics, at X times real time"
    )
    what.add_argument(
        "--export", type=Path, metavar="FILE", help="write the inputs as JSON lines, for kr3_replay"
    )
    parser.add_argument(
        "--any-numbers",
        action="store_true",
        help="the same choices from other numbers count as the same, as in a bag of another machine",
    )
    parser.add_argument("--mission", type=int, metavar="N", help="the bag's Nth mission only")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="N.FIELD=VALUE",
        help="change input N first, as in 12.observation=false",
    )
    parser.add_argument(
        "--continue",
        dest="seed",
        type=int,
        metavar="SEED",
        help="go on in the abstract world where nothing is recorded any more",
    )
    parser.add_argument(
        "--true",
        action="append",
        default=[],
        metavar="LITERAL",
        help="ground literal of the high level that is true in that world",
    )
    parser.add_argument(
        "--domain",
        type=Path,
        metavar="DIR",
        help="files to reason with instead of the recorded ones, which the output names",
    )
    parser.add_argument(
        "--port", type=int, help=f"port of the ROS master for --rate (default: {DEFAULT_PORT})"
    )


def run(args: argparse.Namespace) -> int:
    """@return decisions: 0 all the same, 1 one differs, 2 the bag cannot be used; events and topics: 0 when the bag
    could be read to its end and held a mission"""
    if args.events_only or args.rate is not None:
        return _tell_mission(args)
    try:
        lines = input_lines(args.bag)
        if args.export:
            args.export.write_text("\n".join(lines) + "\n", encoding="utf-8")
            return 0
        return _recompute(args, lines)
    except (Kr3Error, OSError) as error:
        print(f"kr3: {error}", file=sys.stderr)
        return UNUSABLE


def _recompute(args: argparse.Namespace, lines: List[str]) -> int:
    """kr3_replay's exit code. @throws Kr3Error  it could not do its work"""
    with tempfile.TemporaryDirectory(prefix="kr3_replay_") as folder:
        file = Path(folder) / (args.bag.stem + ".jsonl")
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        command = [find_program("kr3_executive", "kr3_replay"), str(file)]
        command += ["--check"] if args.check else []
        command += ["--any-numbers"] if args.any_numbers else []
        command += ["--mission", str(args.mission)] if args.mission is not None else []
        command += ["--continue", str(args.seed)] if args.seed is not None else []
        command += ["--domain", str(args.domain.resolve())] if args.domain is not None else []
        for option in ("set", "true"):
            for value in getattr(args, option):
                command += [f"--{option}", value]
        code = subprocess.run(command, check=False).returncode
    if code not in (0, 1, UNUSABLE):
        raise Kr3Error(f"kr3_replay ended with code {code}")
    return code


def _tell_mission(args: argparse.Namespace) -> int:
    """@return 0 when the bag could be read to its end and held a mission"""
    terminal = Terminal()
    timed = list(read_events(args.bag))
    with open_bag(args.bag) as bag:
        terminal.heading(
            f"{args.bag}: {bag.get_end_time() - bag.get_start_time():.0f} s, {bag.get_message_count()} messages"
        )
        bag_start_s = bag.get_start_time()
    if not timed:
        terminal.verdict(False, "the bag holds no event of a mission")
    if args.events_only:
        for _, event in timed:
            terminal.event(event)
    else:
        if args.rate <= 0.0:
            raise Kr3Error(f"--rate {args.rate}: expected a number > 0")
        _play(args, terminal, [(stamp - bag_start_s, event) for stamp, event in timed])
    return 0 if timed else 1


def read_events(file: Path) -> Iterator[Tuple[float, Event]]:
    """The mission's events with their time in the bag, s. @throws Kr3Error  as open_bag"""
    start_s = None
    with open_bag(file) as bag:
        for _, message, stamp in bag.read_messages(topics=_EVENTS):
            if start_s is None or message.sequence == 0:
                start_s = message.header.stamp.to_sec()
            yield stamp.to_sec(), event_from_message(message, start_s)


def _play(args: argparse.Namespace, terminal: Terminal, timed: List[Tuple[float, Event]]) -> None:
    """Play the whole bag; each event is told when its time comes."""
    with Stack(new_run_dir("replay"), terminal.detail) as stack:
        stack.start_master(choose_port(args.port, DEFAULT_PORT))
        terminal.detail(f"topics on ROS_MASTER_URI={stack.uri}; Ctrl-C ends it")
        player = stack.start_unwatched(
            "player",
            ["rosbag", "play", "--quiet", "-r", str(args.rate), str(args.bag.resolve())],
        )
        started = time.monotonic()
        pending = list(timed)

        def told_up_to_now() -> bool:
            position_s = (time.monotonic() - started) * args.rate
            _tell(pending, position_s, terminal.event)
            return player.exit_code() is not None

        stack.spin_until(told_up_to_now)
        _tell(pending, float("inf"), terminal.event)
        if player.exit_code() != 0:
            raise Kr3Error(f"rosbag play failed:\n{player.log_tail()}")


def _tell(
    pending: List[Tuple[float, Event]], position_s: float, tell: Callable[[Event], Any]
) -> None:
    while pending and pending[0][0] <= position_s:
        tell(pending.pop(0)[1])
