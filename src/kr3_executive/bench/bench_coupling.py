#!/usr/bin/python3
"""Measure the coupling: CPU time from a high-level action to a policy, what a cached policy costs, missions.

A policy is ready when its lower bound is at least 98 % of the best value known: of the greater of the
lower bound that a long run reaches and what its policy earns at least in simulation (95 %). Where that
value is near 0, an absolute regret counts instead. The time runs from the zoom on: generation included.
The goals were set beforehand; each stands beside its figure.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field

from kr3_common.bench_report import write_report

ROOT = pathlib.Path(__file__).resolve().parents[3]
ROOM_SEARCH = pathlib.Path(__file__).with_name("room_search_models.yaml")
NEAR_ZERO, REGRET = 10.0, 0.5


class BenchmarkError(RuntimeError):
    """A program that is missing or failed."""


@dataclass(frozen=True)
class Row:
    """One figure. `value` is None when it was not reached."""

    name: str
    value: float | None
    unit: str
    goal: float | None = None
    better: str = "lower"
    params: dict = field(default_factory=dict)
    runs: list[float] = field(default_factory=list)

    def __str__(self) -> str:
        value = "not reached" if self.value is None else f"{self.value:.4g} {self.unit}"
        line = f"  {self.name:<52} {value:>16}"
        if self.goal is None:
            return line
        met = self.value is not None and (
            self.value <= self.goal if self.better == "lower" else self.value >= self.goal
        )
        relation = "<=" if self.better == "lower" else ">="
        return f"{line}  {'met' if met else 'NOT MET'}, goal {relation} {self.goal:g}"


@dataclass(frozen=True)
class Task:
    """A high-level action in a state."""

    name: str
    domain: str
    state: str
    action: str
    known: tuple[str, ...] = ()
    hidden: tuple[str, ...] = ()
    models: pathlib.Path | None = None
    map: bool = False
    cells: int | None = None
    goal_ms: float | None = None

    def arguments(self) -> list[str]:
        folder = ROOT / "domains" / self.domain
        arguments = [str(folder), "--state", self.state, "--action", self.action]
        for option, texts in (("--known", self.known), ("--hidden", self.hidden)):
            arguments += [part for text in texts for part in (option, text)]
        if self.models is not None:
            arguments += ["--models", str(self.models)]
        if self.map:
            arguments += ["--map", str(folder / "map.yaml")]
        if self.cells is not None:
            arguments += ["--cells-per-place", str(self.cells)]
        return arguments


def office_tasks(cells: int) -> Iterable[Task]:
    """The paper's office with rooms of so many cells, 1 m apart; the robot is in a corner."""
    here = "loc(rob1)=main_library"
    with_book = f"{here}, loc(tb1)=main_library"
    corner = ("loc(rob1)=main_library_c0",)
    even = cells / (cells + 1)  # each cell and elsewhere alike
    goal_ms = {4: 50.0, 9: 1000.0}.get(cells)
    grasp = "grasp(rob1, tb1)"
    yield Task(
        "room search, noise of GOALS",
        "office",
        with_book,
        grasp,
        corner,
        (f"loc(tb1)={even}",),
        ROOM_SEARCH,
        cells=cells,
        goal_ms=goal_ms,
    )
    yield Task(
        "grasp",
        "office",
        with_book,
        grasp,
        corner,
        ("loc(tb1)=0.85",),
        cells=cells,
        goal_ms=goal_ms,
    )
    yield Task("move", "office", here, "move(rob1, kitchen)", corner, cells=cells)
    carrying = f"{with_book}, in_hand(rob1, tb1)"
    yield Task("move with a book", "office", carrying, "move(rob1, kitchen)", corner, cells=cells)
    yield Task("putdown", "office", carrying, "putdown(rob1, tb1)", corner, cells=cells)


def workbench_tasks() -> Iterable[Task]:
    """A device of three modules; nothing here is a place."""
    open_psu = "opened(psu), cause(hum)=psu"
    yield Task(
        "replace",
        "workbench",
        open_psu,
        "replace(tech1, psu, hum)",
        hidden=("cause(hum)=0.7",),
        map=True,
    )
    yield Task("unscrew", "workbench", "cause(hum)=psu", "unscrew(tech1, psu)", map=True)
    yield Task("close", "workbench", open_psu, "close(tech1, psu)", map=True)


class Bench:
    """Runs the measuring programs and keeps the rows.

    @raises BenchmarkError  a program is missing
    """

    def __init__(self, programs: pathlib.Path, quick: bool, runs: int, trials: int) -> None:
        self.quick = quick
        self.runs = runs
        self.trials = trials
        self.rows: list[Row] = []
        self._task = self._program(programs, "kr3_refinement/refinement_bench")
        self._executive = self._program(programs, "kr3_executive/coupling_bench")

    @staticmethod
    def _program(programs: pathlib.Path, name: str) -> str:
        path = programs / name
        if not os.access(path, os.X_OK):
            raise BenchmarkError(f"found no program {path}; build first")
        return str(path)

    def add(self, row: Row) -> None:
        self.rows.append(row)
        print(row, flush=True)

    def tasks(self, tasks: Iterable[Task]) -> None:
        for task in tasks:
            long_run_s = (2.0 if self.quick else 10.0) if task.hidden else 0.5
            options = ["--runs", str(self.runs), "--trials", str(self.trials)]
            options += ["--best-time", str(long_run_s)]
            options += ["--near-zero", str(NEAR_ZERO), "--regret", str(REGRET)]
            self._task_rows(task, answer_of([self._task, *task.arguments(), *options]))

    def _task_rows(self, task: Task, answer: dict) -> None:
        params = {"domain": task.domain, "action": task.action}
        params |= {key: answer[key] for key in ("states", "actions", "observations")}
        title = f"{task.domain}, {task.name}"
        if task.cells is not None:
            params["cells"] = task.cells
            title += f", {task.cells} cells"
        near_zero = abs(answer["best_known"]) < NEAR_ZERO
        wanted = f"regret {REGRET}" if near_zero else "98 %"
        ready = dict(params, target=answer["target"], best_known=answer["best_known"])
        ready |= {"best": answer["best"], "ready": answer["ready"]}
        runs = answer["ready_ms"]
        value = statistics.median(runs) if runs else None
        self.add(Row(f"{title}: {wanted} ready", value, "ms", task.goal_ms, "lower", ready, runs))
        for part in ("zoom_ms", "generate_ms"):
            name = f"{title}: {part.removesuffix('_ms')}"
            runs = answer[part]
            self.add(Row(name, statistics.median(runs), "ms", None, "lower", params, runs))
        step = answer["step"]
        for part in ("lookup_us", "update_us"):
            name = f"{title}: {part.removesuffix('_us')}"
            self.add(Row(name, step[part], "us", None, "lower", params))

    def cache(self) -> None:
        for cells in (4, 9):
            command = [self._executive, "cache", str(ROOT / "domains/office")]
            command += ["--cells", str(cells), "--runs", str(self.runs)]
            for place, thing in (("main_library", "tb1"), ("kitchen", "mug1")):
                state = f"loc(rob1) = {place}; loc({thing}) = {place}"
                known = f"loc(rob1)={place}_c0"
                command += ["--task", f"{state}|grasp(rob1, {thing})|{known}|loc({thing})=0.85"]
            answer = answer_of(command)
            params = {"domain": "office", "cells": cells, "backups": answer["backups"]}
            for kind, cost_us in answer["cost_us"].items():
                name = f"policy, {cells} cells: {kind}"
                self.add(
                    Row(name, statistics.median(cost_us), "us", None, "lower", params, cost_us)
                )

    def missions(self, threads: int) -> None:
        for domain, goal_text in (("office", ""), ("workbench", "resolved(hum)")):
            command = [self._executive, "missions", str(ROOT / "domains" / domain)]
            command += ["--goal", goal_text] if goal_text else []
            command += ["--trials", str(40 if self.quick else 200), "--threads", str(threads)]
            answer = answer_of(command)
            params = {key: answer[key] for key in ("trials", "threads", "achieved", "ll_actions")}
            if not answer["same_when_repeated"]:
                raise BenchmarkError(f"{domain}: the trials did not repeat")
            params |= {"domain": domain, "stats": answer["stats"]}
            for kind in ("cold", "warm"):
                name = f"{domain}, mission: {kind}"
                self.add(Row(name, answer[f"{kind}_ms"], "ms", None, "lower", params))
            rate = answer["trials_per_s"]
            goal = 167.0 if domain == "office" else None
            name = f"{domain}, trials with warm caches"
            self.add(Row(name, rate, "1/s", goal, "higher", params))
            hits = answer["stats"]["hit_rate"]
            self.add(Row(f"{domain}, trials: hits", hits, "", None, "higher", params))

    def floors(self, threads: int) -> None:
        """Trials a second on floors of rooms, from empty caches on: policies and plans included."""
        sizes = (4, 10) if self.quick else (4, 5, 6, 8, 10, 15, 20, 30, 50, 100)
        with tempfile.TemporaryDirectory() as folder:
            for rooms in sizes:
                floor = pathlib.Path(folder) / f"floor_{rooms}"
                make = [str(ROOT / "scripts/make_floor.py"), str(floor), "--rooms", str(rooms)]
                subprocess.run([*make, "--layout", "grid"], check=True, capture_output=True)
                for method, goal in (("pa", 167.0), ("pa_star", 28.0)):
                    self._floor_row(floor, rooms, method, goal, threads)

    def _floor_row(
        self, floor: pathlib.Path, rooms: int, method: str, goal: float, threads: int
    ) -> None:
        trials = max(4, (400 if self.quick else 2000) // rooms)
        command = [self._executive, "missions", str(floor), "--method", method]
        command += ["--trials", str(trials), "--threads", str(threads), "--obedience", "0"]
        answer = answer_of(command)
        params = {key: answer[key] for key in ("trials", "threads", "achieved", "ll_actions")}
        params |= {"rooms": rooms, "method": method, "caches": answer["caches"]}
        params |= {"stats": answer["stats"]}
        for kind, key in (("from empty caches", "cold_trials_per_s"), ("warm", "trials_per_s")):
            name = f"{method}, {rooms} rooms, trials {kind}"
            self.add(Row(name, answer[key], "1/s", goal, "higher", params))
        caches = answer["caches"] | {"policies": answer["stats"]}
        rates = (f"{name} {cache['hit_rate']:.3f}" for name, cache in caches.items())
        print(f"    hit rates: {', '.join(rates)}", flush=True)


def answer_of(command: list[str]) -> dict:
    """@raises BenchmarkError  it failed"""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BenchmarkError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    return json.loads(done.stdout)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="./kr3 bench coupling", description=__doc__)
    parser.add_argument("--programs", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--quick", action="store_true", help="no 16 cells, few trials")
    parser.add_argument("--runs", type=int, help="runs a time (5; quick: 3)")
    parser.add_argument("--trials", type=int, help="simulated trials a value (10000; quick: 1000)")
    parser.add_argument("--threads", type=int, default=2, help="of the missions (%(default)s)")
    parser.add_argument("--sections", default="tasks,cache,missions,floors", help="(%(default)s)")
    parser.add_argument("--json", type=pathlib.Path, help="write the figures to this file")
    args = parser.parse_args(arguments)
    try:
        runs = args.runs or (3 if args.quick else 5)
        trials = args.trials or (1000 if args.quick else 10000)
        bench = Bench(args.programs, args.quick, runs, trials)
        sections = {
            "tasks": lambda: [
                bench.tasks(office_tasks(cells)) for cells in ((4, 9) if args.quick else (4, 9, 16))
            ]
            + [bench.tasks(workbench_tasks())],
            "cache": bench.cache,
            "missions": lambda: bench.missions(args.threads),
            "floors": lambda: bench.floors(args.threads),
        }
        for name in args.sections.split(","):
            if name not in sections:
                raise BenchmarkError(f"section '{name}', expected some of {', '.join(sections)}")
            print(f"\n{name}: medians of CPU times")
            sections[name]()
        if args.json:
            here = pathlib.Path(__file__).parent
            write_report(args.json, "coupling", here, map(vars, bench.rows))
    except BenchmarkError as error:
        print(error, file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
