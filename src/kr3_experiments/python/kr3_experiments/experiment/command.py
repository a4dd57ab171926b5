"""`./kr3 experiment`: runs what is missing of an experiment, then writes its report."""
import argparse
import os
from collections import Counter
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Dict, Iterator, List, Optional, Sequence, Tuple, Union

from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.accuracy import Accuracy
from kr3_experiments.experiment.cluster import DaskExecutor
from kr3_experiments.experiment.default_bias import DefaultBias
from kr3_experiments.experiment.defaults import Defaults
from kr3_experiments.experiment.definition import Experiment, Findings, Options
from kr3_experiments.experiment.learning import Learning
from kr3_experiments.experiment.planning_time import PlanningTime
from kr3_experiments.experiment.points import Configuration, Point, configurations
from kr3_experiments.experiment.report import head, section, write_report
from kr3_experiments.experiment.robot import Robot
from kr3_experiments.experiment.rows import Row, RowStore
from kr3_experiments.experiment.sweep import Executor, LocalExecutor, Work, commit, run_sweep
from kr3_experiments.experiment.worker import trials_program

_TRIALS: Sequence[Experiment] = (Accuracy(), Defaults(), DefaultBias(), Learning())
# The last two have processes of their own, and no trials of kr3_trials.
AnyExperiment = Union[Experiment, PlanningTime, Robot]
_ALL: Sequence[AnyExperiment] = (*_TRIALS, PlanningTime(), Robot())
_EXPERIMENTS: Dict[str, AnyExperiment] = {experiment.name: experiment for experiment in _ALL}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("name", help=f"{', '.join(_EXPERIMENTS)}, or all")
    parser.add_argument("--quick", action="store_true", help="small sizes and few trials")
    parser.add_argument(
        "--out", type=Path, help="folder of the results (default: runs/experiments[_quick])"
    )
    parser.add_argument("--trials", type=int, default=0, help="a point, in place of the protocol's")
    parser.add_argument(
        "--learned",
        action="store_true",
        help="floors with the learned numbers (models_learned.yaml) in place of models.yaml",
    )
    parser.add_argument("--seed", type=int, default=Options.seed, help="of the first trial")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: all cores)"
    )
    parser.add_argument("--scheduler", help="address of a Dask scheduler, such as tcp://HOST:8786")
    parser.add_argument(
        "--report-only", action="store_true", help="of the rows that are there; run nothing"
    )


def run(args: argparse.Namespace) -> int:
    """@return the exit code. @throws Kr3Error  a name, a range or a folder is wrong, or a trial fails"""
    if args.name != "all" and args.name not in _EXPERIMENTS:
        raise Kr3Error(
            f"unknown experiment '{args.name}'; there are {', '.join(_EXPERIMENTS)}, all"
        )
    for option, least in (("trials", 0), ("seed", 0), ("jobs", 1)):
        if getattr(args, option) < least:
            raise Kr3Error(
                f"--{option}: found {getattr(args, option)}, expected a number from {least}"
            )
    options = Options(args.quick, args.seed, args.trials, args.learned, args.jobs)
    out = args.out or repository_root() / "runs" / ("experiments" + "_quick" * args.quick)
    names = list(_EXPERIMENTS) if args.name == "all" else [args.name]
    sections: List[Tuple[str, List[str], Findings]] = []
    with _executor(args, out) as executor:
        for name in names:
            experiment = _EXPERIMENTS[name]
            print(f"{experiment.title} ({name})", flush=True)
            findings, notes = _results(experiment, options, out / name, executor)
            for statement in findings.statements:
                print(f"  {statement}")
            lines = section(
                experiment.title, experiment.claim, experiment.protocol, findings, notes
            )
            page = write_report(
                out / name,
                experiment.title,
                head(experiment.title, _facts(options)) + lines,
                findings,
            )
            print(f"  report: {page}", flush=True)
            nested = section(
                experiment.title, experiment.claim, experiment.protocol, findings, notes, f"{name}/"
            )
            sections.append((name, nested, findings))
    if args.name == "all":
        lines = head("Experiments", _facts(options))
        for _, nested, _ in sections:
            lines += nested
        print(f"All of them: {write_report(out, 'Experiments', lines, Findings())}")
    return 0


def _facts(options: Options) -> Dict[str, str]:
    return {
        "commit of this report": commit(),
        "seeds": f"from {options.seed}",
        "numbers of the floors": ("models_learned.yaml" if options.learned else "models.yaml")
        + " (robot and learning have their own)",
        "trials a point": str(options.trials or ("quick" if options.quick else "by the protocol")),
    }


@contextmanager
def _executor(args: argparse.Namespace, out: Path) -> Iterator[Optional[Executor]]:
    """Where trials run; nowhere with --report-only."""
    if args.report_only:
        yield None
        return
    if args.scheduler:
        cluster = DaskExecutor(args.scheduler)
        try:
            yield cluster
        finally:
            cluster.close()
        return
    try:
        (out / "policies").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Kr3Error(f"cannot write results to '{out}': {error.strerror}") from error
    yield LocalExecutor(trials_program(), args.jobs, out / "policies")


def experiment_named(name: str) -> AnyExperiment:
    """@throws Kr3Error  there is none of this name"""
    if name not in _EXPERIMENTS:
        raise Kr3Error(f"unknown experiment '{name}'; there are {', '.join(_EXPERIMENTS)}, all")
    return _EXPERIMENTS[name]


def _points(experiment: Experiment, options: Options) -> List[Point]:
    """With --learned on floors of the learned numbers; `learning` has numbers of its own."""
    points = experiment.points(options)
    if not options.learned or isinstance(experiment, Learning):
        return points
    return [
        replace(point, floor=replace(point.floor, models="models_learned.yaml")) for point in points
    ]


def stored_rows(experiment: AnyExperiment, options: Options, folder: Path) -> List[Row]:
    """The rows that are there. @throws Kr3Error  there are none"""
    if not (folder / "rows.csv").exists():
        raise Kr3Error(f"'{folder}' has no rows of {experiment.name}: run it first")
    if isinstance(experiment, (PlanningTime, Robot)):
        return experiment.measure(folder, options, run=False)
    store = RowStore(folder, experiment.labels)
    points = configurations(_points(experiment, options), folder / "floors")
    return store.of([point.digest for point in points])


def _results(
    experiment: AnyExperiment, options: Options, folder: Path, executor: Optional[Executor]
) -> Tuple[Findings, List[str]]:
    """The findings, and notes about the rows."""
    notes: List[str] = []
    wanted = 0
    if executor is not None:
        wanted, notes = _run_missing(experiment, options, folder, executor)
    rows = stored_rows(experiment, options, folder)
    if not rows:
        raise Kr3Error(f"'{folder}' has no rows of {experiment.name}: run it first")
    if len(rows) < wanted:
        notes.append(
            f"{wanted - len(rows)} trials are missing: the figures are of those that are there"
        )
    made_at = Counter(row["commit"] for row in rows)
    commits = ", ".join(f"{count} at {name}" for name, count in sorted(made_at.items()))
    notes.append(
        f"raw rows: {len(rows)}, in rows.csv, made by the programs of the commits: {commits}"
    )
    return experiment.findings(rows, options), notes


def _run_missing(
    experiment: AnyExperiment, options: Options, folder: Path, executor: Executor
) -> Tuple[int, List[str]]:
    """@return how many trials there should be, and notes about what was done"""
    if isinstance(experiment, (PlanningTime, Robot)):
        return len(experiment.measure(folder, options)), []
    store = RowStore(folder, experiment.labels)
    notes = [f"kept aside in {store.rejected_path.name}: {what}" for what in store.rejected]
    for note in notes:
        print(f"  {note}")
    points = configurations(_points(experiment, options), folder / "floors")
    notes += _work_notes(points, run_sweep(points, store, executor))
    return sum(len(point.point.all_seeds()) for point in points), notes


def _work_notes(points: Sequence[Configuration], work: Dict[str, Work]) -> List[str]:
    """What this run took, a configuration a line."""
    notes = []
    for point in points:
        done = work.get(point.digest)
        if done is None or not done.trials:
            continue
        asked = done.policy_hits + done.policy_misses
        rate = (
            f", {done.policy_hits / asked:.1%} of {asked} policies from the cache" if asked else ""
        )
        label = ", ".join(f"{name} {value}" for name, value in point.point.label.items())
        notes.append(
            f"this run: {label}: {done.trials} trials in {done.cpu_s:.1f} s of CPU,"
            f" {done.trials / done.cpu_s:.1f} a second{rate}"
        )
    return notes
