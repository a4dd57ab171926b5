"""`./kr3 map`: the mapping phase. The robot drives through the building and navigation_node writes its OctoMap."""
import argparse
import os
from pathlib import Path
from typing import Any, Dict

from kr3_experiments.bringup import add_domain_argument, choose_port, new_run_dir, package_config
from kr3_experiments.domain import load_domain, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.stack import Stack
from kr3_experiments.stack_file import load_stack
from kr3_experiments.terminal import Terminal


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    add_domain_argument(parser)
    parser.add_argument(
        "--seed", type=int, default=1, help="seed of the simulated noise (default: 1)"
    )
    parser.add_argument(
        "--real-time-factor",
        type=float,
        default=5.0,
        metavar="X",
        help="simulated s per s (default: 5)",
    )
    parser.add_argument("--port", type=int, help="port of the ROS master (default: a free one)")
    parser.add_argument(
        "--time-limit", type=float, default=900.0, metavar="S", help="wall time, s (default: 900)"
    )
    parser.add_argument(
        "--output", type=Path, help="where the map goes (default: the domain's map.bt)"
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 when the map was written"""
    terminal = Terminal()
    domain = load_domain(args.domain, repository_root())
    output = (args.output or domain.map_file).resolve()
    before = _stamp(output)
    run_dir = new_run_dir("map")
    variables: Dict[str, Any] = {
        "domain_dir": str(domain.folder),
        "run_dir": str(run_dir),
        "map_out": str(output),
        "seed": args.seed,
        "robot_start": domain.robot_start,
        "real_time_factor": args.real_time_factor,
    }
    with Stack(run_dir, terminal.detail) as stack:
        stack.start_master(choose_port(args.port))
        stack.start_nodes(load_stack(package_config("mapping_stack.yaml"), variables))
        terminal.heading("The robot drives through all rooms")
        tour = stack.start_unwatched("build_map", [stack.executable("kr3_navigation", "build_map")])
        if not stack.spin_until(lambda: tour.exit_code() is not None, args.time_limit):
            raise Kr3Error(
                f"the map was not finished within {args.time_limit:.0f} s (see {tour.log})"
            )
    terminal.line(tour.log_tail(5))
    if tour.exit_code() != 0 or _stamp(output) == before:
        raise Kr3Error(f"no map was written to {output} (see {tour.log})")
    terminal.verdict(True, f"map written: {output} ({os.path.getsize(output) / 1000:.0f} kB)")
    return 0


def _stamp(file: Path) -> float:
    return file.stat().st_mtime if file.exists() else 0.0
