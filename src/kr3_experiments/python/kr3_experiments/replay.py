"""`./kr3 replay`: play a bag's topics on a master and tell its mission again."""
import argparse
import time
from pathlib import Path
from typing import Any, Callable, Iterator, List, Tuple

import rosbag

from kr3_experiments.bringup import DEFAULT_PORT, choose_port, new_run_dir
from kr3_experiments.errors import Kr3Error
from kr3_experiments.events import Event, event_from_message
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal

_EVENTS = ("executive/events", "/executive/events")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("bag", type=Path)
    parser.add_argument(
        "--rate", type=float, default=1.0, metavar="X", help="times real time (default: 1)"
    )
    parser.add_argument(
        "--events-only", action="store_true", help="tell the mission at once, play nothing"
    )
    parser.add_argument(
        "--port", type=int, help=f"port of the ROS master (default: {DEFAULT_PORT})"
    )


def run(args: argparse.Namespace) -> int:
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


def open_bag(file: Path) -> rosbag.Bag:
    """@throws Kr3Error  no such file, or it is not a complete bag"""
    try:
        return rosbag.Bag(str(file))
    except OSError as error:
        raise Kr3Error(f"{file}: {error.strerror or error}") from error
    except rosbag.ROSBagUnindexedException as error:
        raise Kr3Error(
            f"{file} was not closed properly: `rosbag reindex {file}` makes it readable"
        ) from error
    except rosbag.ROSBagException as error:
        raise Kr3Error(f"{file} is not a bag: {error}") from error


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
            ["rosrun", "rosbag", "play", "--quiet", "-r", str(args.rate), str(args.bag.resolve())],
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
