"""How far learned models are from true ones. Knows no ROS."""
import math
from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, Mapping, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.counts import Counts, share

Distribution = Mapping[str, float]


@dataclass
class ModelError:
    """Distances between true and learned distributions, one for each that is not exact."""

    transitions: List[float] = field(default_factory=list)  # total variation, of T
    observations: List[float] = field(default_factory=list)  # total variation, of O
    divergences: List[float] = field(default_factory=list)  # of both, nats
    intervals: int = 0  # of probabilities, at 95 %
    covered: int = 0  # those that hold the true one

    @property
    def transition_error(self) -> float:
        """Mean total variation of T."""
        return _mean(self.transitions)

    @property
    def observation_error(self) -> float:
        """Mean total variation of O."""
        return _mean(self.observations)

    @property
    def divergence(self) -> float:
        """Mean of Kullback and Leibler's divergence, of the learned distribution from the true one."""
        return _mean(self.divergences)


def total_variation(first: Distribution, second: Distribution) -> float:
    """Half the sum of differences, [0, 1]. What one of them does not list has probability 0."""
    names = first.keys() | second.keys()
    return sum(abs(first.get(name, 0.0) - second.get(name, 0.0)) for name in names) / 2


def kl_divergence(true: Distribution, learned: Distribution) -> float:
    """sum p log(p / q) in nats; infinite where `learned` has 0 for what may happen."""
    result = 0.0
    for name, p in true.items():
        if p > 0.0:
            q = learned.get(name, 0.0)
            result += p * math.log(p / q) if q > 0.0 else math.inf
    return result


def model_error(
    true: Mapping[str, Any], learned: Mapping[str, Any], counts: Mapping[str, Counts]
) -> ModelError:
    """Compare the numbers for all arguments of every action that errs; numbers of classes are not compared.

    @param true, learned  models files as they are read. @param counts  by action, from which `learned` comes
    @throws Kr3Error  the two are not of the same actions
    """
    error = ModelError()
    others = {key.partition("(")[0]: entry or {} for key, entry in learned["actions"].items()}
    for key, entry in true["actions"].items():
        name = key.partition("(")[0]
        if name not in others:
            raise Kr3Error(f"the learned models have no action '{name}'")
        mine = dict(_distributions(entry or {}))
        theirs = dict(_distributions(others[name]))
        if mine.keys() != theirs.keys():
            raise Kr3Error(f"the models of '{name}' have different outcomes or observations")
        for (kind, fluent, truth), p in mine.items():
            q = theirs[kind, fluent, truth]
            target = error.transitions if kind == "outcomes" else error.observations
            target.append(total_variation(p, q))
            error.divergences.append(kl_divergence(p, q))
        if name in counts:
            _cover(error, mine, counts[name])
    return error


def _distributions(
    entry: Mapping[str, Any]
) -> Iterator[Tuple[Tuple[str, str, bool], Distribution]]:
    """(kind, fluent, truth) -> distribution, of those that are not exact."""
    if "outcomes" in entry:
        yield ("outcomes", "", True), entry["outcomes"]["probabilities"]
    for fluent, sensor in (entry.get("observations") or {}).items():
        if sensor == "exact":
            continue
        for truth, name in ((True, "true_positive"), (False, "false_positive")):
            if name in sensor:
                yield ("sensor", fluent, truth), {"yes": sensor[name], "no": 1.0 - sensor[name]}


def _cover(
    error: ModelError, true: Mapping[Tuple[str, str, bool], Distribution], counts: Counts
) -> None:
    """Count the credible intervals that hold the true probability; of two that sum to 1 one counts."""
    for (kind, fluent, truth), distribution in true.items():
        numbers: Dict[str, int] = dict(counts.outcomes)
        if kind == "sensor":
            sensor = counts.sensors.get(fluent)
            if sensor is None:
                continue
            numbers = (
                {"yes": sensor.true_positive, "no": sensor.false_negative}
                if truth
                else {"yes": sensor.false_positive, "no": sensor.true_negative}
            )
        total = sum(numbers.values())
        names = list(numbers)[:1] if len(numbers) == 2 else list(numbers)
        for name in names if total > 0 else []:
            interval = share(numbers[name], total, len(numbers))
            error.intervals += 1
            error.covered += interval.low <= distribution[name] <= interval.high


def _mean(values: List[float]) -> float:
    return sum(values) / len(values) if values else 0.0
