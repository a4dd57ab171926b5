"""Trials a CPU-second of the experiment `defaults`, each point in a process of its own with empty caches."""
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Sequence

from kr3_experiments.experiment.defaults import Defaults
from kr3_experiments.experiment.definition import Options
from kr3_experiments.experiment.points import Configuration, configurations
from kr3_experiments.experiment.worker import Reply, TrialWorker

# Trials a second on two cores: 10,000 at each of ten sizes in 10 minutes, and in 60.
GOALS = {"pa": 167.0, "pa_star": 28.0}


@dataclass(frozen=True)
class Throughput:
    """What the first trials of a point took."""

    method: str
    rooms: int
    trials: int
    successes: int
    cpu_s: float  # of one process
    hit_rates: Dict[str, float]  # by cache

    @property
    def rate(self) -> float:
        """Trials a CPU-second."""
        return self.trials / self.cpu_s if self.cpu_s > 0 else 0.0


def measure(program: str, sizes: Sequence[int], trials: int) -> List[Throughput]:
    """Run the first `trials` of the experiment's points with so many rooms, those that obey as its headline says.

    @param program  kr3_trials. @param sizes  numbers of rooms
    """
    points = Defaults.headline(Options(trials=trials), sizes)
    with tempfile.TemporaryDirectory(prefix="kr3_throughput_") as folder:
        return [_measured(program, one) for one in configurations(points, Path(folder))]


def _measured(program: str, configuration: Configuration) -> Throughput:
    point = configuration.point
    trials = [point.target.trial(seed) for seed in point.all_seeds()]
    worker = TrialWorker(program)
    try:
        replies = worker.run(configuration.digest, configuration.files, point.job, trials)
    finally:
        worker.close()
    rows, end = replies[:-1], replies[-1]
    return Throughput(
        method=str(point.label["method"]),
        rooms=int(point.label["rooms"]),
        trials=len(rows),
        successes=sum(row["declared"] and row["goal_true"] for row in rows),
        cpu_s=end["cpu_s"],
        hit_rates=_hit_rates(end),
    )


def _hit_rates(end: Reply) -> Dict[str, float]:
    counts = {name: (both[0], both[1]) for name, both in end["caches"].items()}
    counts["policies"] = (end["policy_hits"], end["policy_misses"])
    return {
        name: hits / (hits + misses) for name, (hits, misses) in counts.items() if hits + misses
    }
