"""`./kr3 up`: the whole stack, until Ctrl-C."""
import argparse

from kr3_experiments.bringup import (
    DEFAULT_PORT,
    RunNote,
    add_world_options,
    choose_port,
    new_run_dir,
    start_stack,
    world_from,
)
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    add_world_options(parser)


def run(args: argparse.Namespace) -> int:
    """Runs until a signal or until the stack breaks down, which raises."""
    terminal = Terminal()
    world = world_from(args)
    world.domain.require_map()
    if args.stack is None:  # another stack may do without a detector
        world.domain.require_model()
    run_dir = new_run_dir("up")
    terminal.heading("Starting the stack")
    with Stack(run_dir, terminal.detail) as stack:
        stack.start_master(choose_port(args.port, DEFAULT_PORT))
        with RunNote(stack.uri, run_dir):
            start_stack(stack, world, run_dir, args.stack)
            terminal.heading(
                f"The robot is ready. ROS_MASTER_URI={stack.uri}, logs in {run_dir}/log; Ctrl-C ends it."
            )
            terminal.detail('another terminal: ./kr3 status, ./kr3 goal "FORMULA", ./kr3 record')
            stack.spin_until(lambda: False)
    return 0
