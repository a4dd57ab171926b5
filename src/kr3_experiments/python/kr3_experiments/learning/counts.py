"""Attempts of the training phase, their counts and the posteriors of what they tell. Knows no ROS.

Posteriors: Beta for an observation, Dirichlet for outcomes, both from Jeffreys' prior of one half for each value; a
duration is a mean with its standard deviation.
"""
import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Dict, Iterable, List, Optional, Sequence, TextIO, Tuple

from scipy import stats

from kr3_experiments.errors import Kr3Error

PRIOR = 0.5  # pseudo-count of each value


@dataclass(frozen=True)
class Observed:
    """What one observation law said, and what was true. A law that tells a value has `said` = whether it was right."""

    fluent: str
    truth: bool
    said: bool
    tells_value: bool = False


@dataclass(frozen=True)
class Attempt:
    """One trial of a low-level action."""

    action: str
    arguments: Tuple[str, ...]
    possible: bool
    outcome: str  # label; "" when the action's laws have none, or none fits
    observed: Tuple[Observed, ...]
    duration_s: float
    metres: Optional[float] = None  # that the robot drove, where the cost depends on it


@dataclass(frozen=True)
class Interval:
    """Mean and equal-tailed credible interval."""

    mean: float
    low: float
    high: float


def share(
    count: int, total: int, values: int = 2, prior: float = PRIOR, level: float = 0.95
) -> Interval:
    """The posterior of a share after `count` of `total`; of one label among `values` it is the Dirichlet's margin."""
    a = count + prior
    b = total - count + (values - 1) * prior
    return Interval(
        a / (a + b), stats.beta.ppf((1 - level) / 2, a, b), stats.beta.ppf((1 + level) / 2, a, b)
    )


@dataclass
class Sensor:
    """Counts of one observed fluent."""

    tells_value: bool = False
    true_positive: int = 0
    false_negative: int = 0
    false_positive: int = 0
    true_negative: int = 0

    def add(self, observed: Observed) -> None:
        """Count one observation."""
        self.tells_value = observed.tells_value
        if observed.truth:
            self.true_positive += observed.said
            self.false_negative += not observed.said
        else:
            self.false_positive += observed.said
            self.true_negative += not observed.said

    @property
    def total(self) -> int:
        """All observations."""
        return self.true_positive + self.false_negative + self.false_positive + self.true_negative


@dataclass
class Durations:
    """Seconds of trials that were carried out, and of trials in vain, with the metres driven."""

    carried_out: List[Tuple[float, float]] = field(default_factory=list)  # metres, seconds
    impossible: List[float] = field(default_factory=list)

    def line(self, with_metres: bool) -> Tuple[float, float, float]:
        """(seconds at 0 m, seconds a metre, standard deviation about that line); least squares, neither below 0.

        @throws Kr3Error  nothing was carried out
        """
        if not self.carried_out:
            raise Kr3Error("no trial was carried out")
        n = len(self.carried_out)
        mean_x = sum(x for x, _ in self.carried_out) / n
        mean_y = sum(y for _, y in self.carried_out) / n
        spread = sum((x - mean_x) ** 2 for x, _ in self.carried_out)
        slope = 0.0
        if with_metres and spread > 1e-9:
            slope = sum((x - mean_x) * (y - mean_y) for x, y in self.carried_out) / spread
            slope = max(0.0, slope)
        base = mean_y - slope * mean_x
        if base < 0.0:  # then the best line through the origin
            base = 0.0
            slope = sum(x * y for x, y in self.carried_out) / sum(
                x * x for x, _ in self.carried_out
            )
        rest = sum((y - base - slope * x) ** 2 for x, y in self.carried_out)
        return base, slope, math.sqrt(rest / max(1, n - (2 if slope > 0.0 else 1)))


@dataclass
class Counts:
    """What was counted for one action, or for one class of its arguments."""

    outcomes: Dict[str, int] = field(default_factory=dict)
    sensors: Dict[str, Sensor] = field(default_factory=dict)
    durations: Durations = field(default_factory=Durations)
    unexplained: int = 0  # possible trials whose result is none of the action's outcomes

    def add(self, attempt: Attempt, labels: Sequence[str]) -> None:
        """Count one attempt. @param labels  of the action's outcomes, all of which get a count"""
        for label in labels:
            self.outcomes.setdefault(label, 0)
        if not attempt.possible:
            self.durations.impossible.append(attempt.duration_s)
            return
        if labels and attempt.outcome not in self.outcomes:
            self.unexplained += 1
        elif labels:
            self.outcomes[attempt.outcome] += 1
        for observed in attempt.observed:
            self.sensors.setdefault(observed.fluent, Sensor()).add(observed)
        self.durations.carried_out.append((attempt.metres or 0.0, attempt.duration_s))


class AttemptLog:
    """A file with one attempt a line. Whatever was written stays: an interrupted training phase goes on from it.

    @throws Kr3Error  a line is not an attempt (the last one may be torn: it is dropped), or the file is of another run
    """

    def __init__(self, path: Path, about: Dict[str, Any]):
        self.attempts: List[Attempt] = []
        self.dropped = False
        lines = path.read_bytes().split(b"\n") if path.exists() else []
        kept: List[bytes] = []
        for number, line in enumerate(lines, 1):
            if not line.strip():
                continue
            try:
                content = json.loads(line)
            except ValueError as error:
                if number == len(lines):
                    self.dropped = True
                    continue
                raise Kr3Error(f"{path}:{number}: not JSON: {error}") from error
            if not kept:
                _same_run(content, about, path)
            else:
                self.attempts.append(_attempt(content, f"{path}:{number}"))
            kept.append(line)
        if self.dropped:
            path.write_bytes(b"".join(line + b"\n" for line in kept))
        self._file: TextIO = path.open("a", encoding="utf-8")
        if not kept:
            self._write({"about": about})

    def add(self, attempt: Attempt) -> None:
        """Keep an attempt, on the disk before this returns."""
        self.attempts.append(attempt)
        self._write(asdict(attempt))

    def _write(self, content: Dict[str, Any]) -> None:
        self._file.write(json.dumps(content) + "\n")
        self._file.flush()

    def close(self) -> None:
        """No more attempts."""
        self._file.close()


def read_attempts(path: Path) -> List[Attempt]:
    """The attempts of a file. @throws Kr3Error  there is none, or it is malformed"""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise Kr3Error(f"{path}: {error.strerror}") from error
    attempts = []
    for number, line in enumerate(lines, 1):
        try:
            content = json.loads(line)
        except ValueError as error:
            raise Kr3Error(f"{path}:{number}: not JSON: {error}") from error
        if not (isinstance(content, dict) and "about" in content):
            attempts.append(_attempt(content, f"{path}:{number}"))
    return attempts


def _same_run(content: Any, about: Dict[str, Any], path: Path) -> None:
    found = content.get("about") if isinstance(content, dict) else None
    if found != about:
        raise Kr3Error(
            f"{path}:1: these attempts are about {found}, expected {about}: take another --run-dir"
        )


def _attempt(content: Any, where: str) -> Attempt:
    try:
        attempt = Attempt(
            str(content["action"]),
            tuple(str(item) for item in content["arguments"]),
            bool(content["possible"]),
            str(content["outcome"]),
            tuple(
                Observed(
                    str(o["fluent"]), bool(o["truth"]), bool(o["said"]), bool(o.get("tells_value"))
                )
                for o in content["observed"]
            ),
            float(content["duration_s"]),
            None if content.get("metres") is None else float(content["metres"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(f"{where}: not an attempt: missing or malformed {error}") from error
    if not (math.isfinite(attempt.duration_s) and attempt.duration_s >= 0.0):
        raise Kr3Error(f"{where}: duration_s is {attempt.duration_s}, expected seconds, >= 0")
    return attempt


def count(attempts: Iterable[Attempt], labels: Dict[str, List[str]]) -> Dict[str, Counts]:
    """Counts by action. @param labels  of each action's outcomes"""
    result: Dict[str, Counts] = {}
    for attempt in attempts:
        result.setdefault(attempt.action, Counts()).add(attempt, labels.get(attempt.action, []))
    return result


def agree(first: Interval, second: Interval) -> bool:
    """Whether two estimates of the same number are within each other's reach: their intervals overlap."""
    return first.low <= second.high and second.low <= first.high
