"""`./kr3 bench experiments`: figures beside their goals from rows that are there, and trials a second."""
import argparse
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Sequence

from kr3_common.bench_report import write_report

from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.accuracy import sizes_behind
from kr3_experiments.experiment.command import experiment_named, stored_rows
from kr3_experiments.experiment.definition import Options, false_declarations, select, success_of
from kr3_experiments.experiment.learning import Groups
from kr3_experiments.experiment.robot import times_of_pairs
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.throughput import GOALS, Throughput, measure
from kr3_experiments.experiment.worker import trials_program


@dataclass
class Figure:
    """A row of the bench's JSON."""

    name: str
    value: float
    unit: str
    goal: Optional[float]
    better: str
    params: Dict[str, Any] = field(default_factory=dict)

    def line(self) -> str:
        """For people."""
        goal = "" if self.goal is None else f"  goal {self.goal:g}"
        met = ""
        if self.goal is not None:
            reached = self.value <= self.goal if self.better == "lower" else self.value >= self.goal
            met = "  met" if reached else "  NOT met"
        params = ", ".join(f"{key} {value}" for key, value in self.params.items())
        return f"  {self.name:<34} {self.value:>9.4g} {self.unit:<6}{goal}{met}  {params}"


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("--quick", action="store_true", help="rows of --quick experiments")
    parser.add_argument("--trials", type=int, default=0, help="as the experiments were run with")
    parser.add_argument("--learned", action="store_true", help="likewise")
    parser.add_argument("--seed", type=int, default=Options.seed, help="likewise")
    parser.add_argument("--out", type=Path, help="folder of the rows (default: runs/experiments)")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    parser.add_argument(
        "--throughput",
        type=int,
        nargs="+",
        default=[],
        metavar="ROOMS",
        help="run the first trials of `defaults` on floors of so many rooms, and tell how many a CPU-second are run",
    )
    parser.add_argument(
        "--throughput-trials", type=int, default=200, help="of each of these (default: 200)"
    )


def run(args: argparse.Namespace) -> int:
    """@return 1 when no experiment has rows. @throws Kr3Error  the file cannot be written"""
    options = Options(args.quick, args.seed, args.trials, args.learned)
    out = args.out or repository_root() / "runs" / ("experiments" + "_quick" * args.quick)
    figures: List[Figure] = []
    for name, figures_of in _FIGURES.items():
        try:
            rows = stored_rows(experiment_named(name), options, out / name)
        except Kr3Error as error:
            print(f"{name}: {error}", file=sys.stderr)
            continue
        print(f"{name}: {len(rows)} rows")
        found = figures_of(rows)
        figures += found
        for figure in found:
            print(figure.line())
    if args.throughput:
        print(f"throughput: {args.throughput_trials} trials a point, from empty caches")
        for point in measure(trials_program(), args.throughput, args.throughput_trials):
            figures.append(_throughput(point))
            print(figures[-1].line())
    if args.json:
        try:
            write_report(args.json, "experiments", repository_root(), map(asdict, figures))
        except OSError as error:
            raise Kr3Error(f"cannot write '{args.json}': {error.strerror}") from error
    return 0 if figures else 1


def _throughput(point: Throughput) -> Figure:
    params = {
        "method": point.method,
        "rooms": point.rooms,
        "success": round(point.successes / point.trials, 3),
        "hits": {name: round(rate, 3) for name, rate in sorted(point.hit_rates.items())},
    }
    # Two processes share the work of the experiment.
    goal = GOALS[point.method] / 2
    return Figure("trials a CPU-second", point.rate, "1/s", goal, "higher", params)


def _accuracy(rows: Sequence[Row]) -> List[Figure]:
    """PA's success at each size; where each budget of POMDP-1 falls behind."""
    figures = []
    for noise in sorted({row["noise"] for row in rows}):
        here = select(rows, noise=noise)
        pa = select(here, method="pa")
        for cells in sorted({row["cells"] for row in pa}):
            group = select(pa, cells=cells)
            params = {"cells": cells, "noise": noise, "trials": len(group)}
            goal = (
                0.95 if noise == 1.0 and cells <= 400 else None
            )  # the double noise is shown beside
            figures.append(
                Figure("PA, success", success_of(group).value, "", goal, "higher", params)
            )
        for method in ("pomdp1", "pomdp1_online"):
            for seconds in sorted({row["seconds"] for row in select(here, method=method)}):
                behind = sizes_behind(select(here, method=method, seconds=seconds), pa)
                params = {"method": method, "cpu_s": seconds, "noise": noise}
                if behind:
                    figures.append(
                        Figure(
                            "POMDP-1 falls behind at", behind[0], "cells", None, "higher", params
                        )
                    )
    return figures


def _defaults(rows: Sequence[Row]) -> List[Figure]:
    figures = []
    for method in ("pa", "pa_star"):
        mine = select(rows, method=method)
        params = {"method": method, "trials": len(mine)}
        figures.append(
            Figure("success, all points", success_of(mine).value, "", None, "higher", params)
        )
        figures.append(
            Figure("false declarations", false_declarations(mine), "", 0, "lower", params)
        )
    return figures


def _robot(rows: Sequence[Row]) -> List[Figure]:
    figures = []
    for first, second, goal, better in (
        ("hierarchical", "pa", 1.64, "higher"),
        ("pa", "oracle", 1.3, "lower"),
    ):
        result = times_of_pairs(rows, first, second)
        if result is None:
            continue
        params = {
            "pairs": result.pairs,
            "interval": [result.ratio.low, result.ratio.high],
            "wilcoxon_p": result.wilcoxon_p,
        }
        name = f"time, {first} by {second}"
        # The first goal is what the paper found, to be compared with.
        figures.append(Figure(name, result.ratio.value, "", goal, better, params))
    lost = sum(not row["success"] for row in rows)
    figures.append(Figure("missions lost", lost, "", 0, "lower", {"missions": len(rows)}))
    return figures


def _learning(rows: Sequence[Row]) -> List[Figure]:
    """Model error, stated intervals that hold the truth, and actions lost, at each number of samples."""
    groups = Groups(rows)
    figures = []
    for n in groups.samples:
        params = {"samples": n, "trainings": len(groups.trainings(n))}
        for column, text in (("error_t", "T, total variation"), ("error_o", "O, total variation")):
            figures.append(Figure(text, groups.error(n, column).value, "", None, "lower", params))
        covered = groups.coverage(n).value
        figures.append(Figure("intervals holding the truth", covered, "", None, "higher", params))
        loss = groups.loss(n, "ll_actions")
        if loss is not None:
            interval = {**params, "interval": [loss.low, loss.high]}
            figures.append(
                Figure("more LL actions than true models", loss.value, "", None, "lower", interval)
            )
    return figures


_FIGURES: Dict[str, Callable[[Sequence[Row]], List[Figure]]] = {
    "accuracy": _accuracy,
    "defaults": _defaults,
    "robot": _robot,
    "learning": _learning,
}
