#!/usr/bin/python3
"""Measure the POMDP solver: bounds over time, values of its policies, memory, loading, lookups, deadlines.

Times are CPU seconds after loading, one thread. The goals beside the figures are those of
pomdp_benchmark/goals.py, with what APPL's SARSOP measured. With --data the published files are used, without it
problems generated from their formulas. With --peer an APPL pomdpsol runs in turns with the solver, and
its figures of this session count.
"""

import argparse
import pathlib
import sys
import tempfile

from kr3_common.bench_report import write_report
from pomdp_benchmark import ablation, bounds, published, rooms, sections
from pomdp_benchmark.figures import summary
from pomdp_benchmark.goals import ROOMS
from pomdp_benchmark.peer import Peer
from pomdp_benchmark.processes import BenchmarkError, Programs
from pomdp_benchmark.session import Session, room_file

SECTIONS = {
    "bounds": "bounds at the given times, and the time to APPL's gap",
    "solved": "time to a gap of 1e-3 on the small problems",
    "rooms": "room search: bounds and simulated values beside a greedy rule",
    "policies": "simulated values of the policies after the longest time",
    "threads": "two threads against one",
    "loading": "reading a large factored model",
    "deadlines": "how late a run ends",
    "lookups": "action of a policy at a belief, in the library",
    "calls": "the same as a ROS service",
    "ablation": "room search with parts of the solver left out one by one",
    "models": "generated problems beside the published files",
}
USUAL = [name for name in SECTIONS if name not in ("calls", "ablation", "models")]
QUICK = ["bounds", "solved", "rooms", "policies", "deadlines"]
QUICK_PROBLEMS = ["4x3.95.pomdp", "Hallway.pomdp", "TagAvoid.pomdpx", "RoomSearch_9.pomdp"]
SOLVED = ["4x3.95.pomdp", "RockSample_4_4.pomdp"]


def parse_args(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./kr3 bench pomdp",
        description=__doc__,
        epilog="Sections: " + "; ".join(f"{name}: {what}" for name, what in SECTIONS.items()),
    )
    parser.add_argument("--programs", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--problems", help="names or model files, with commas (all of the goals)")
    parser.add_argument("--times", help="CPU seconds, with commas (1,10,60; quick: 0.1,0.5)")
    parser.add_argument("--sections", help=f"with commas ({','.join(USUAL)})")
    parser.add_argument("--data", type=pathlib.Path, help="folder with the published files")
    parser.add_argument("--peer", type=pathlib.Path, help="an APPL pomdpsol to run in turns")
    parser.add_argument("--trials", type=int, help="simulated trials a value (10000; quick: 1000)")
    parser.add_argument("--runs", type=int, help="repetitions of short runs (5; quick: 3)")
    parser.add_argument("--seed", type=int, default=1, help="of the simulations")
    parser.add_argument("--quick", action="store_true", help="a few problems, short times")
    parser.add_argument("--json", type=pathlib.Path, help="write the figures to this file")
    return parser.parse_args(arguments)


def chosen(given: str | None, known: list[str] | None, usual: list[str], what: str) -> list[str]:
    """The parts of a list with commas; `usual` without one.

    @raises BenchmarkError  a part that is not known
    """
    names = [part.strip() for part in given.split(",")] if given else usual
    for name in names:
        if known is not None and name not in known:
            raise BenchmarkError(f"unknown {what} '{name}', expected one of {', '.join(known)}")
    return names


def seconds(text: str) -> tuple[float, ...]:
    """@raises BenchmarkError  not numbers"""
    try:
        return tuple(sorted(float(part) for part in text.split(",")))
    except ValueError as error:
        raise BenchmarkError(f"found times '{text}', expected numbers with commas") from error


def run_sections(session: Session, names: list[str], problems: list[str]) -> bool:
    """Each section that was asked for, in the order of SECTIONS; false when one of them failed."""
    files = {problem: session.file(problem).name for problem in problems}
    solved = [problem for problem, file in files.items() if file in SOLVED]
    # Room search has a section of its own, and is not simulated twice.
    valued = [problem for problem, file in files.items() if not file.startswith("RoomSearch")]
    sizes = [cells for cells in ROOMS if room_file(cells) in files.values()]
    room_times = tuple(t for t in (0.1, 1.0, 10.0, 60.0) if t <= max(session.times))
    runs = {
        "bounds": lambda: bounds.measure(session, problems),
        "solved": lambda: bounds.time_to_solve(session, solved),
        "rooms": lambda: rooms.measure(session, sizes, room_times or session.times),
        "policies": lambda: sections.policies(session, valued),
        "threads": lambda: sections.threads(session, valued),
        "loading": lambda: sections.loading(session),
        "deadlines": lambda: sections.deadlines(session, problems),
        "lookups": lambda: sections.lookups(session),
        "calls": lambda: sections.calls(session),
        "ablation": lambda: ablation.measure(session, sizes),
        "models": lambda: published.measure(session),
    }
    all_ran = True
    for name, run_section in runs.items():
        if name in names:
            try:
                run_section()
            except BenchmarkError as error:
                print(f"{name}: {error}", file=sys.stderr)
                all_ran = False
    return all_ran


def main(arguments: list[str] | None = None) -> int:
    args = parse_args(arguments)
    try:
        names = chosen(args.sections, list(SECTIONS), QUICK if args.quick else USUAL, "section")
        with tempfile.TemporaryDirectory() as folder:
            session = Session(
                programs=Programs(args.programs),
                scratch=pathlib.Path(folder),
                data=args.data,
                peer=Peer(args.peer) if args.peer else None,
                times=seconds(args.times or ("0.1,0.5" if args.quick else "1,10,60")),
                runs=args.runs or (3 if args.quick else 5),
                trials=args.trials or (1000 if args.quick else 10000),
                seed=args.seed,
            )
            usual = QUICK_PROBLEMS if args.quick else session.known()
            problems = chosen(args.problems, None, usual, "problem")
            for problem in problems:
                session.file(problem)
            all_ran = run_sections(session, names, problems)
            print(f"\n{summary(session.figures)}")
        if args.json:
            options = {"times": session.times, "seed": args.seed, "trials": session.trials}
            options["data"] = "published" if args.data else "generated"
            rows = (figure.as_json() for figure in session.figures)
            here = pathlib.Path(__file__).parent
            write_report(args.json, "pomdp", here, rows, options=options)
    except BenchmarkError as error:
        print(error, file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0 if all_ran else 1


if __name__ == "__main__":
    sys.exit(main())
