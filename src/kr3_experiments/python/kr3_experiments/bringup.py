"""From command-line options to a running stack, and the note that tells other commands where it runs."""
import argparse
import json
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, Optional, Sequence

import yaml

from kr3_experiments.domain import Domain, load_domain, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.master import free_port, is_master
from kr3_experiments.stack import Stack
from kr3_experiments.stack_file import NodeSpec, load_stack
from kr3_experiments.variant import with_start
from kr3_experiments.yaml_file import read_mapping

DEFAULT_PORT = 11311
DEFAULT_DOMAIN = "office"
_DOMAIN_HELP = f"folder below domains/ (default: {DEFAULT_DOMAIN}), or the path of another"
_REAL_TIME_FACTOR = 4.0
LOCKSTEP_FACTOR = (
    8.0  # what a message takes between nodes, some ms of wall time, stays below a tenth of a second
)
_LOCKSTEP_PATIENCE_S = 120.0  # wall time that the simulation waits for a node that is not heard of
STATE_FILE = "executive_state.json"  # of the stack file: what a run's executive knows
METHODS = ["pa", "pa_star", "pomdp1", "pomdp2", "hierarchical"]


@dataclass(frozen=True)
class World:
    """What distinguishes one run from another."""

    domain: Domain
    seed: int
    target_at: str
    real_time_factor: float  # 0: as fast as possible
    method: str = METHODS[0]  # of the executive
    models: str = (
        "models.yaml"  # that the robot plans with and believes by; file in the domain's folder
    )
    told: bool = False  # the robot is told where the target is: an oracle to compare with
    lockstep: bool = False  # the simulation waits for the nodes


def add_domain_argument(parser: argparse.ArgumentParser) -> None:
    """The domain that a command works on, in place of an option."""
    parser.add_argument(
        "domain",
        nargs="?",
        default=DEFAULT_DOMAIN,
        help=_DOMAIN_HELP,
    )


def add_world_options(parser: argparse.ArgumentParser) -> None:
    """The options that `world_from` reads."""
    parser.add_argument(
        "--domain",
        default=DEFAULT_DOMAIN,
        help=_DOMAIN_HELP,
    )
    parser.add_argument(
        "--seed", type=int, default=1, help="seed of the simulated world and its noise (default: 1)"
    )
    parser.add_argument("--target-at", metavar="PLACE", help="where the object asked for really is")
    parser.add_argument(
        "--start", metavar="PLACE", help="where the robot starts, and knows that it does"
    )
    parser.add_argument(
        "--real-time-factor",
        type=float,
        metavar="X",
        help=f"simulated s per s of wall time, at most (default: {_REAL_TIME_FACTOR:g}, in lockstep"
        f" {LOCKSTEP_FACTOR:g}); 0: as fast as possible",
    )
    parser.add_argument(
        "--lockstep",
        action="store_true",
        help="the simulation waits for navigation and detection; thinking takes its wall time",
    )
    parser.add_argument(
        "--method",
        choices=METHODS,
        default=METHODS[0],
        help="of planning: KR3's (pa) or a baseline",
    )
    parser.add_argument(
        "--models",
        default="models.yaml",
        metavar="FILE",
        help="the robot's numbers, such as models_learned.yaml: file in the domain's folder, or a path",
    )
    parser.add_argument("--told", action="store_true", help="tell the robot where the object is")
    parser.add_argument("--port", type=int, help="port of the ROS master")
    parser.add_argument(
        "--stack", type=Path, metavar="FILE", help="another list of nodes than config/stack.yaml"
    )


def world_from(args: argparse.Namespace) -> World:
    """@throws Kr3Error  unknown domain or place, bad number"""
    domain = load_domain(args.domain, repository_root())
    factor = args.real_time_factor
    if factor is None:
        factor = LOCKSTEP_FACTOR if args.lockstep else _REAL_TIME_FACTOR
    if not factor >= 0.0:
        raise Kr3Error(f"--real-time-factor {args.real_time_factor}: expected a number >= 0")
    if not 0 <= args.seed < 2**31:
        raise Kr3Error(f"--seed {args.seed}: expected a number from 0 to {2**31 - 1}")
    if args.start is not None:
        domain = with_start(domain, args.start, args.seed)
    place = args.target_at or domain.target.at
    domain.placements_with_target(place)
    if not (domain.folder / args.models).is_file():
        known = ", ".join(sorted(path.name for path in domain.folder.glob("models*.yaml")))
        raise Kr3Error(f"--models {args.models}: no such file; {domain.folder} has {known}")
    return World(
        domain,
        args.seed,
        place,
        factor,
        args.method,
        args.models,
        args.told,
        args.lockstep,
    )


def stack_variables(world: World, run_dir: Path) -> Dict[str, Any]:
    """The placeholders of a stack file. @throws Kr3Error  the robot cannot be told where the target is"""
    return {
        "method": world.method,
        "models": str((world.domain.folder / world.models).resolve()),
        "scenario": str(_scenario_file(world, run_dir)),
        "domain_dir": str(world.domain.folder),
        "run_dir": str(run_dir),
        "seed": world.seed,
        "placements": world.domain.placements_with_target(world.target_at),
        "robot_start": world.domain.robot_start,
        "real_time_factor": world.real_time_factor,
    }


def _scenario_file(world: World, run_dir: Path) -> Path:
    """The domain's own, or one with the records of this world and, for who is told, of where the target is."""
    scenario = read_mapping(world.domain.scenario_file)
    records = list(world.domain.initial_records)
    if world.told:
        statement = f"{world.domain.target_fluent()} = {world.target_at}"
        records.append({"kind": "init", "statement": statement, "value": True})
    if records == scenario["initial_records"]:
        return world.domain.scenario_file
    scenario.update(initial_records=records, goal=world.domain.goal)
    file = run_dir / "scenario.yaml"
    file.write_text(yaml.safe_dump(scenario, sort_keys=False), encoding="utf-8")
    return file


def package_config(name: str) -> Path:
    """A file of kr3_experiments/config."""
    return repository_root() / "src" / "kr3_experiments" / "config" / name


def start_stack(
    stack: Stack, world: World, run_dir: Path, stack_file: Optional[Path], needs_map: bool = True
) -> None:
    """Start every node of the stack file on the stack's master.

    @throws Kr3Error  no map, bad stack file; StackError  a node did not come up
    """
    if needs_map:
        world.domain.require_map()
    file = stack_file or package_config("stack.yaml")
    specs = load_stack(file, stack_variables(world, run_dir), world.lockstep)
    start_followers(stack, specs)
    stack.start_nodes(specs)


def start_followers(stack: Stack, specs: Sequence[NodeSpec]) -> None:
    """Programs that acknowledge, in lockstep, for nodes that know nothing of it."""
    for spec in specs:
        if spec.follow is not None:
            program = stack.executable("kr3_sim_ode", "lockstep_follow")
            command = [program, spec.name, spec.follow.topic]
            command += [str(spec.follow.period_s), "--timeout", str(_LOCKSTEP_PATIENCE_S)]
            stack.start_process(f"lockstep_{spec.name}", command)


def new_run_dir(kind: str) -> Path:
    """A new folder below runs/ for what this run leaves behind."""
    base = repository_root() / "runs"
    stamp = time.strftime("%Y-%m-%d_%H%M%S")
    for suffix in ("", *(f"_{number}" for number in range(2, 100))):
        folder = base / f"{stamp}_{kind}{suffix}"
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        except OSError as error:
            raise Kr3Error(f"the run's folder {folder} cannot be made: {error.strerror}") from error
        return folder
    raise Kr3Error(f"no free folder name below {base}")


def existing_run_dir(folder: Path) -> Path:
    """The folder that was asked for, made when there is none. @throws Kr3Error  it cannot be made"""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Kr3Error(f"the run's folder {folder} cannot be made: {error.strerror}") from error
    return folder.resolve()


def choose_port(requested: Optional[int], default: Optional[int] = None) -> int:
    """The port asked for, else `default`, else a free one."""
    return requested or default or free_port()


class RunNote:
    """`runs/current.json` while a stack runs: where its master is."""

    def __init__(self, uri: str, run_dir: Path):
        self._file = repository_root() / "runs" / "current.json"
        self._content = {"master": uri, "run_dir": str(run_dir), "pid": os.getpid()}

    def __enter__(self) -> "RunNote":
        self._file.parent.mkdir(exist_ok=True)
        self._file.write_text(json.dumps(self._content) + "\n", encoding="utf-8")
        return self

    def __exit__(self, *_: object) -> None:
        try:
            if json.loads(self._file.read_text(encoding="utf-8")) == self._content:
                self._file.unlink()
        except (OSError, json.JSONDecodeError):
            pass  # somebody else's note by now


def running_master(uri: Optional[str], report: Callable[[str], None] = print) -> str:
    """The master to talk to: the one given, else the one of the last stack that was started.

    @throws Kr3Error  none is running
    """
    if uri is None:
        file = repository_root() / "runs" / "current.json"
        try:
            note = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, json.JSONDecodeError) as error:
            raise Kr3Error("no robot is running: start it with ./kr3 up") from error
        uri = note["master"]
        report(f"(master {uri}, started by process {note['pid']})")
    if not is_master(uri):
        raise Kr3Error(
            f"no ROS master answers at {uri}: is the robot still running? Start it with ./kr3 up"
        )
    return uri
