#!/usr/bin/python3
"""Measure the reasoner: CPU seconds of whole processes, growth with the size, and warm answers.

Every figure is a median over runs of one process each. The single-shot literal encoding of the fetch
plan (literal_encoding.py) is solved in the same run, with a time limit; so is SPARC when --sparc-jar
names it. The goals were set beforehand; each stands beside its figure.
"""

import argparse
import json
import pathlib
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

import literal_encoding
import rooms_domain
from kr3_common.bench_report import write_report
from rooms_domain import GOAL, PARCEL_GOAL, Size

FETCH_STEPS = 4
SURPRISE_STEPS = 80
SURPRISES = 19


@dataclass(frozen=True)
class Row:
    """One figure. `value` is None when the run did not end in time."""

    name: str
    size: Size
    value: float | None
    goal: float | None
    runs: list[float] = field(default_factory=list)
    answer: dict = field(default_factory=dict)

    def as_json(self) -> dict:
        return {
            "name": self.name,
            "value": self.value,
            "unit": "s",
            "goal": self.goal,
            "better": "lower",
            "params": {"rooms": self.size.rooms, "objects": self.size.objects},
            "runs": self.runs,
            "answer": self.answer,
        }


class Bench:
    """Runs questions; each in a process of its own."""

    def __init__(
        self, binary: pathlib.Path, folder: pathlib.Path, runs: int, limit_s: float
    ) -> None:
        self.binary = binary
        self.folder = folder
        self.runs = runs
        self.limit_s = limit_s
        self.rows: list[Row] = []

    def files(self, size: Size, history: str, text: str) -> list[str]:
        """Writes the domain and a history; returns their paths."""
        folder = self.folder / f"{size.rooms}x{size.objects}_{history}"
        folder.mkdir(exist_ok=True)
        (folder / "domain.kr3").write_text(rooms_domain.domain(size, exogenous=history == "moved"))
        (folder / "history.kr3").write_text(text)
        return [str(folder / "domain.kr3"), str(folder / "history.kr3")]

    def measure(
        self,
        name: str,
        size: Size,
        arguments: list[str],
        goal: float | None,
        runs: int | None = None,
    ) -> Row:
        """CPU seconds of a process, or what it says itself of a repeated question."""
        seconds: list[float] = []
        answer: dict = {}
        for _ in range(runs or self.runs):
            used, output = cpu_seconds([str(self.binary), *arguments], self.limit_s)
            if output is None:
                break
            answer = json.loads(output)
            seconds.append(answer.pop("cpu_s", used))
        row = Row(
            name, size, statistics.median(seconds) if seconds else None, goal, seconds, answer
        )
        self.rows.append(row)
        print_row(row)
        return row


def cpu_seconds(command: list[str], limit_s: float) -> tuple[float, str | None]:
    """CPU time of a process, user and system; no output when it took longer than the limit.

    @raises RuntimeError  the command failed
    """

    def limit() -> None:
        seconds = int(limit_s) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=limit)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return used, None
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    return used, done.stdout


def print_row(row: Row) -> None:
    value = "none in time" if row.value is None else f"{row.value:.4f} s"
    goal = "" if row.goal is None else f"goal {row.goal:g}"
    print(
        f"  {row.name:<34} {str(row.size):>10}  {value:>14}  {goal:<10} {json.dumps(row.answer)}",
        flush=True,
    )


def fetch_plans(bench: Bench, sizes: dict[Size, float], largest_literal: int) -> None:
    for size, goal in sizes.items():
        files = bench.files(size, "start", rooms_domain.start(size))
        cold = bench.measure(
            "fetch plan, all knowledge", size, ["plan", *files, GOAL, "--all-knowledge"], goal
        )
        bench.measure("fetch plan, relevant", size, ["plan", *files, GOAL], 0.03)
        bench.measure(
            "fetch plan, relevant + 20 %",
            size,
            ["plan", *files, GOAL, "--extra-share", "0.2"],
            0.3 * cold.value if cold.value else None,
        )
        record = "hpd(move(rob1, main_library), 0)."
        replan = ["replan", *files, GOAL, record]
        bench.measure("one more record, relevant", size, replan, 0.001, runs=1)
        bench.measure(
            "one more record, all knowledge",
            size,
            [*replan, "--all-knowledge"],
            0.1 * cold.value if cold.value else None,
            runs=1,
        )
        if size.rooms <= largest_literal:
            path = bench.folder / f"literal_{size.rooms}x{size.objects}.lp"
            path.write_text(literal_encoding.fetch_plan(size, FETCH_STEPS))
            bench.measure("fetch plan, literal encoding", size, ["ground", str(path)], None, runs=1)


def histories(bench: Bench, quick: bool) -> None:
    small = Size(20, 50)
    files = bench.files(
        small, "surprises", rooms_domain.surprises(small, SURPRISE_STEPS, SURPRISES)
    )
    bench.measure(
        f"entailment, {SURPRISE_STEPS} steps",
        small,
        ["entails", *files, "loc(tb5) = aux_library"],
        0.3,
    )
    for size, goal in [(small, 0.10)] + ([] if quick else [(Size(80, 200), 0.8)]):
        files = bench.files(size, "moved", rooms_domain.moved(size))
        bench.measure("diagnosis, exogenous actions", size, ["diagnose", *files], goal)
    missions(bench, small, quick)
    middle = Size(40, 100)
    files = bench.files(middle, "open", rooms_domain.open_places(middle))
    bench.measure("plans for 39 hypotheses", middle, ["plan", *files, PARCEL_GOAL], 0.5)


def missions(bench: Bench, size: Size, quick: bool) -> None:
    """CPU seconds a step; `ratio` is that of the last 100 steps to the first 100."""
    files = bench.files(size, "start", rooms_domain.start(size))
    steps = "400" if quick else "1000"
    command = ["mission", *files, "--steps", steps, "--window", "10"]
    bench.measure("step of a mission, progressed", size, command, None, runs=1)
    command = ["mission", *files, "--steps", "200"]
    bench.measure("step of a mission, 200 steps kept", size, command, None, runs=1)


def growth(rows: list[Row]) -> None:
    """How the time grows from the smallest size to the largest."""
    print("\nGrowth with rooms x objects")
    for name in dict.fromkeys(row.name for row in rows):
        of_name = [row for row in rows if row.name == name and row.value]
        if len(of_name) > 1:
            of_name.sort(key=lambda row: row.size.rooms * row.size.objects)
            first, last = of_name[0], of_name[-1]
            sizes = last.size.rooms * last.size.objects / (first.size.rooms * first.size.objects)
            times = last.value / first.value
            print(f"  {name:<34} {times:6.1f} times the time for {sizes:.0f} times the size")


def sparc(bench: Bench, jar: str, size: Size) -> None:
    """Runs SPARC on a program that the user keeps beside its jar, named program.sp."""
    program = pathlib.Path(jar).with_name("program.sp")
    used, output = cpu_seconds(["java", "-jar", jar, str(program), "-A"], bench.limit_s)
    row = Row("fetch plan, SPARC", size, used if output is not None else None, None, [used])
    bench.rows.append(row)
    print_row(row)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--binary", type=pathlib.Path, required=True, help="the built reasoner_bench"
    )
    parser.add_argument("--quick", action="store_true", help="small sizes, three runs each")
    parser.add_argument("--runs", type=int, help="runs a figure (5; quick: 3)")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU seconds a process may take")
    parser.add_argument("--json", type=pathlib.Path, help="write the figures to this file")
    parser.add_argument("--sparc-jar", help="a SPARC jar with the 20 x 50 program.sp beside it")
    args = parser.parse_args()
    goals = {Size(10, 200): 0.10, Size(20, 50): 0.06, Size(40, 100): 0.15, Size(80, 200): 0.50}
    sizes = {size: goal for size, goal in goals.items() if not args.quick or size.rooms <= 20}
    if not args.quick:
        sizes[Size(200, 1000)] = 0.0
    print("CPU seconds, whole process, median; repeated questions: of one answer in process")
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(
            args.binary, pathlib.Path(folder), args.runs or (3 if args.quick else 5), args.limit
        )
        large = sizes.pop(Size(200, 1000), None)
        fetch_plans(bench, sizes, largest_literal=20)
        if large is not None:
            size = Size(200, 1000)
            files = bench.files(size, "start", rooms_domain.start(size))
            bench.measure("fetch plan, relevant", size, ["plan", *files, GOAL], 0.03)
        histories(bench, args.quick)
        if args.sparc_jar:
            sparc(bench, args.sparc_jar, Size(20, 50))
        growth(bench.rows)
    if args.json:
        rows = (row.as_json() for row in bench.rows)
        write_report(args.json, "reasoner", pathlib.Path(__file__).parent, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
