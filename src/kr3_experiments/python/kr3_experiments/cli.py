"""The commands behind ./kr3: options, dispatch, and one place where failures become messages and exit codes."""
import argparse
import importlib
import signal
import sys
from typing import Dict, List, NamedTuple

from kr3_experiments.errors import Kr3Error


class Interrupted(KeyboardInterrupt):
    """A signal asks the program to end."""

    def __init__(self, number: int):
        super().__init__(f"interrupted by {signal.Signals(number).name}")
        self.number = number


class Command(NamedTuple):
    """`module` has add_options(parser) and run(args) -> exit code; it is imported only when the command runs."""

    module: str
    summary: str


_COMMANDS: Dict[str, Command] = {
    "demo": Command("demo", "run the whole mission; record a bag, write a report"),
    "up": Command("up", "start the master and every node until Ctrl-C"),
    "goal": Command("goal", "give the running robot a goal and follow the mission"),
    "status": Command("status", "say what the running robot is doing"),
    "record": Command("record", "record a bag of the running robot until Ctrl-C"),
    "replay": Command("replay", "compute a bag's decisions again, or play it"),
    "map": Command("mapping", "let the robot drive and build the map of a domain"),
    "train": Command("training", "learn to see a domain's objects from rendered pictures"),
    "learn": Command("learning.command", "learn the low level's numbers from trials"),
    "experiment": Command(
        "experiment.command", "run an experiment of the paper, and write its report"
    ),
    "bench_experiments": Command(
        "experiment.bench", "print the figures of stored experiments beside their goals"
    ),
    "doctor": Command("doctor", "say what would not work on this machine"),
}


def main(arguments: List[str]) -> int:
    """@return 0 success, 1 failure, 2 bad usage, 3 no stack came up, 128 + number of the signal that ended it"""
    name = arguments[0] if arguments else ""
    if name not in _COMMANDS:
        print(f"kr3: unknown command '{name}'; there are {', '.join(_COMMANDS)}", file=sys.stderr)
        return 2
    command = _COMMANDS[name]
    module = importlib.import_module(f"kr3_experiments.{command.module}")
    parser = argparse.ArgumentParser(prog=f"kr3 {name}", description=command.summary)
    module.add_options(parser)
    args = parser.parse_args(arguments[1:])
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _interrupt)
    try:
        return module.run(args)
    except Kr3Error as error:
        print(f"kr3: {error}", file=sys.stderr)
        return error.exit_code
    except Interrupted as error:
        print(f"kr3: {error}", file=sys.stderr)
        return 128 + error.number


def _interrupt(number: int, _frame: object) -> None:
    raise Interrupted(number)
