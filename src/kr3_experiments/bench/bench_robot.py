#!/usr/bin/python3
"""Measure the robot: driving, localisation, maps, rooms, simulator, camera, perception, the whole loop.

The goals were set beforehand. What a part's own program measures is asked of that program; one that is missing is said
and left out. Times are CPU times of one thread unless a row says `wall`.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, field

import robot_perception
import whole_loop
from kr3_common.bench_report import write_report

ROOT = pathlib.Path(__file__).resolve().parents[3]
FLOORS = ("floor_a", "floor_b")
LASER_LAYER = (0.2, 0.4)  # m: heights of the map's nodes that the laser's plane touches


class BenchmarkError(RuntimeError):
    """A program that is missing or failed."""


@dataclass(frozen=True)
class Row:
    """One figure."""

    name: str
    value: float
    unit: str
    goal: float | None = None
    better: str = "lower"
    params: dict = field(default_factory=dict)
    runs: list[float] = field(default_factory=list)

    def __str__(self) -> str:
        line = f"  {self.name:<52} {self.value:>10.4g} {self.unit:<10}"
        if self.goal is None:
            return line
        met = self.value <= self.goal if self.better == "lower" else self.value >= self.goal
        relation = "<=" if self.better == "lower" else ">="
        return f"{line} {'met' if met else 'NOT MET'}, goal {relation} {self.goal:g}"


class Bench:
    """Runs the measuring programs and keeps the rows."""

    def __init__(self, programs: pathlib.Path, quick: bool, seed: int, work: pathlib.Path) -> None:
        self._programs = programs
        self.work = work
        self.quick = quick
        self.seed = seed
        self.rows: list[Row] = []

    def add(self, name: str, value: float, unit: str, **more) -> None:
        row = Row(name, value, unit, **more)
        self.rows.append(row)
        print(row, flush=True)

    def program(self, package: str, name: str) -> str:
        """@throws BenchmarkError  it is not built"""
        path = self._programs / package / name
        if not os.access(path, os.X_OK):
            raise BenchmarkError(f"{path} is missing: build the workspace first")
        return str(path)

    def run(self, command: list[str], timeout_s: float | None = None) -> str:
        """Run a program to its end. @return its output. @throws BenchmarkError  it failed or took too long"""
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=timeout_s
            )
        except subprocess.TimeoutExpired as error:
            raise BenchmarkError(f"{' '.join(command)} took over {timeout_s:g} s") from error
        if done.returncode != 0:
            raise BenchmarkError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
        return done.stdout

    def figures(self, package: str, name: str, *arguments: str, may_fail: bool = False) -> dict:
        """What a program writes with --json. @throws BenchmarkError  it failed"""
        file = self.work / f"{name}.json"
        file.unlink(missing_ok=True)
        command = [self.program(package, name), *arguments, "--json", str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not file.exists() or (done.returncode != 0 and not may_fail):
            raise BenchmarkError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
        return json.loads(file.read_text(encoding="utf-8"))

    def trials(self, command: str, domain: str, map_file: pathlib.Path, *arguments: str) -> dict:
        """navigation_trials in a domain's building."""
        folder = ROOT / "domains" / domain
        return self.figures(
            "kr3_experiments",
            "navigation_trials",
            command,
            str(folder / "building.yaml"),
            str(folder / "objects.yaml"),
            str(map_file),
            "--seed",
            str(self.seed),
            *arguments,
            may_fail=True,  # a drive that fails is a figure, not an error
        )

    def costs(self) -> None:
        """What each scan costs."""
        runs = [
            self.trials(
                "costs", FLOORS[0], ROOT / "domains" / FLOORS[0] / "map.bt", "--runs", "300"
            )
            for _ in range(1 if self.quick else 5)
        ]
        for name, key, goal in (
            ("OctoMap insertion, 360 beams, 0.1 m", "insertion_ms", 1.0),
            ("localisation per scan, 400 particles", "localisation_ms", 0.9),
        ):
            values = sorted(run[key] for run in runs)
            self.add(name, values[len(values) // 2], "ms", goal=goal, runs=values)

    def drives(self) -> None:
        """From cells to others in the floors of 15 rooms."""
        runs = 10 if self.quick else 100
        conditions = {
            "": (),
            ", half of the furniture moved": ("--moved-furniture", "0.5"),
        }
        for condition, arguments in conditions.items():
            answers = [
                self.trials(
                    "drive",
                    floor,
                    ROOT / "domains" / floor / "map.bt",
                    "--runs",
                    str(runs),
                    *arguments,
                )
                for floor in FLOORS
            ]
            params = {"floors": list(FLOORS), "drives": runs * len(FLOORS), "seed": self.seed}
            scans = sum(answer["errors"]["scans"] for answer in answers)

            def mean(key: str, answers=answers, scans=scans) -> float:
                weighted = (answer["errors"][key] * answer["errors"]["scans"] for answer in answers)
                return sum(weighted) / scans

            succeeded = sum(answer["succeeded"] for answer in answers)
            refused = sum(answer["rightly_refused"] for answer in answers)
            more = {"params": params}
            # Without contact: arrived, or refused with a reason where every way is too narrow.
            self.add(
                f"drives as they should be{condition}",
                succeeded / params["drives"],
                "share",
                goal=1.0,
                better="higher",
                **more,
            )
            self.add(
                f"drives that arrived{condition}",
                (succeeded - refused) / params["drives"],
                "share",
                **more,
            )
            self.add(f"drives rightly refused{condition}", refused, "", **more)
            contacts = sum(answer["contacts"] for answer in answers)
            self.add(f"contacts{condition}", contacts, "", goal=0, **more)
            self.add(f"pose error, mean{condition}", 100 * mean("mean_m"), "cm", goal=2.0, **more)
            worst = max(answer["errors"]["max_m"] for answer in answers)
            self.add(f"pose error, greatest{condition}", 100 * worst, "cm", goal=10.0, **more)
            self.add(
                f"normalised squared error (2 = honest){condition}",
                mean("normalised_squared_error"),
                "",
                **more,
            )
            ratio = sorted(answer["time_ratio_median"] for answer in answers)[-1]
            self.add(f"time against the straight optimum{condition}", ratio, "", **more)

    def shut_doors(self) -> None:
        """Drives with a third of the doors shut: a goal behind one is called unreachable, with the door's name."""
        runs = 6 if self.quick else 20
        answer = self.trials(
            "drive",
            FLOORS[0],
            ROOT / "domains" / FLOORS[0] / "map.bt",
            "--runs",
            str(runs),
            "--shut-doors",
            "0.33",
        )
        self.add(
            "drives as they should be, a third of the doors shut",
            answer["succeeded"] / runs,
            "share",
            goal=1.0,
            better="higher",
            params={"drives": runs},
        )

    def maps(self) -> None:
        """Maps that the robot builds, with known and with its own poses, against the world's own."""
        floor = FLOORS[0]
        folder = ROOT / "domains" / floor
        truth = self.work / "truth.bt"
        low, high = (str(height) for height in LASER_LAYER)
        world = [
            self.program("kr3_sim_ode", "world_octomap"),
            str(folder / "building.yaml"),
            str(folder / "objects.yaml"),
            str(truth),
            "--z-min",
            low,
            "--z-max",
            high,
            "--seed",
            str(self.seed),
        ]
        done = subprocess.run(world, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BenchmarkError(f"world_octomap failed:\n{done.stdout}{done.stderr}")
        for poses, flags in (("known poses", ()), ("own poses", ("--own-poses",))):
            if self.quick and flags:
                continue
            built = self.work / "built.bt"
            report = self.trials("map", floor, built, *flags)
            if flags:
                self.add(
                    f"map, {poses}: greatest pose error", 100 * report["errors"]["max_m"], "cm"
                )
            check = self.figures(
                "kr3_navigation",
                "check_map",
                str(built),
                "--truth",
                str(truth),
                "--building",
                str(folder / "building.yaml"),
            )
            for voxels in check["voxels"]:
                where = "" if voxels["tolerance"] == 0 else " within a node"
                for key in (
                    "occupied_precision",
                    "occupied_recall",
                    "free_precision",
                    "free_recall",
                ):
                    name = f"map, {poses}: {key.replace('_', ' ')}{where}"
                    self.add(name, voxels[key], "share", better="higher")
            rooms = check["rooms"]
            params = {key: rooms[key] for key in ("segments", "over_segmented", "under_segmented")}
            self.add(
                f"rooms from the map, {poses}: mean IoU",
                rooms["mean_iou"],
                "",
                better="higher",
                params=params,
            )

    def simulator(self) -> None:
        """The rows of sim_bench, which names their goals itself."""
        folder = ROOT / "domains" / FLOORS[0]
        command = [
            self.program("kr3_sim_ode", "sim_bench"),
            str(folder / "building.yaml"),
            str(folder / "objects.yaml"),
            "--json",
            *(["--quick"] if self.quick else []),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BenchmarkError(f"sim_bench failed:\n{done.stdout}{done.stderr}")
        for entry in json.loads(done.stdout):
            more = {key: entry[key] for key in ("goal", "better", "params", "runs") if key in entry}
            self.add(f"simulator: {entry['name']}", entry["value"], entry["unit"], **more)


PARTS: dict[str, Callable[[Bench], None]] = {
    "costs": Bench.costs,
    "drives": Bench.drives,
    "doors": Bench.shut_doors,
    "maps": Bench.maps,
    "simulator": Bench.simulator,
    "perception": robot_perception.measure,
    "loop": whole_loop.measure,
}


def main(arguments: list[str] | None = None) -> int:
    """@return 0 when every part could be measured"""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--programs", type=pathlib.Path, required=True, help="devel/lib")
    parser.add_argument("--quick", action="store_true", help="fewer drives and runs")
    parser.add_argument("--seed", type=int, default=1, help="of drives, maps and pictures")
    parser.add_argument("--only", choices=PARTS, action="append", help="this part; may be repeated")
    parser.add_argument("--json", type=pathlib.Path, help="write the rows there")
    args = parser.parse_args(arguments)
    failed = False
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(args.programs, args.quick, args.seed, pathlib.Path(work))
        for name in args.only or PARTS:
            print(f"{name}:", flush=True)
            try:
                PARTS[name](bench)
            except (BenchmarkError, OSError) as error:
                failed = True
                print(f"  not measured: {error}", file=sys.stderr, flush=True)
    if args.json:
        write_report(args.json, "robot", ROOT, map(asdict, bench.rows))
    return 1 if failed or not bench.rows else 0


if __name__ == "__main__":
    sys.exit(main())
