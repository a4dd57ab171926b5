"""Attempts of the training phase, their counts and the posteriors of what they tell. Knows no ROS.

Posteriors: Beta for an observation, Dirichlet for outcomes, both from Jeffreys' prior of one half for each value; a
duration is a mean with its standard deviation.
"""
import json
import math
from dataclasses import asdict, dataclass, field, replace
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
    # Trials of one visit, between two changes of place, are not independent: the robot looks from the same pose, at
    # things that lie the same way. None: independent of all others.
    visit: Optional[int] = None


@dataclass(frozen=True)
class Interval:
    """Mean and equal-tailed credible interval."""

    mean: float
    low: float
    high: float


Trials = Sequence[Tuple[Optional[int], bool]]  # visit (None: of its own), and whether it was so


def share(
    count: int,
    total: int,
    values: int = 2,
    prior: float = PRIOR,
    level: float = 0.95,
    effective: Optional[float] = None,
) -> Interval:
    """The posterior of a share after `count` of `total`; of one label among `values` it is the Dirichlet's margin.

    @param effective  how many independent trials these tell as much as, (0, total]: widens the interval about the mean
    """
    mean = (count + prior) / (total + values * prior)
    size = total if effective is None else effective
    hits = size * (count / total if total else 0.0)
    a = hits + prior
    b = size - hits + (values - 1) * prior
    low, high = (stats.beta.ppf((1 + side * level) / 2, a, b) for side in (-1, 1))
    return Interval(mean, min(mean, low), max(mean, high))


def effective_size(trials: Trials) -> float:
    """How many independent trials these tell as much as, since those of one visit resemble each other.

    Trials by the design effect of the share's variance between visits, at least 1, and by what few visits leave
    uncertain about that variance (Korn and Graubard 1998, Survey Methodology 24). Where all trials came out alike the
    design effect cannot be told, and is taken for 1.
    """
    n = len(trials)
    sizes: Dict[Any, List[bool]] = {}
    for number, (visit, hit) in enumerate(trials):
        sizes.setdefault(("alone", number) if visit is None else visit, []).append(hit)
    m = len(sizes)
    if m == n or n == 0:
        return float(n)
    if m == 1:
        return 1.0
    p = sum(hit for _, hit in trials) / n
    effect = 1.0
    if 0.0 < p < 1.0:
        between = sum((sum(hits) - p * len(hits)) ** 2 for hits in sizes.values())
        effect = max(1.0, m / (m - 1) * between / (n * p * (1 - p)))
    few = stats.t.ppf(0.975, n - 1) / stats.t.ppf(0.975, m - 1)
    return float(max(1.0, n / effect * few**2))


@dataclass
class Sensor:
    """Counts of one observed fluent."""

    tells_value: bool = False
    true_positive: int = 0
    false_negative: int = 0
    false_positive: int = 0
    true_negative: int = 0
    trials: Dict[bool, List[Tuple[Optional[int], bool]]] = field(default_factory=dict)  # by truth

    def add(self, observed: Observed, visit: Optional[int] = None) -> None:
        """Count one observation."""
        self.tells_value = observed.tells_value
        self.trials.setdefault(observed.truth, []).append((visit, observed.said))
        if observed.truth:
            self.true_positive += observed.said
            self.false_negative += not observed.said
        else:
            self.false_positive += observed.said
            self.true_negative += not observed.said

    def interval(self, truth: bool) -> Interval:
        """The posterior of Pr(yes) where it is so, or where it is not; of a law that tells a value, of its truth."""
        yes = self.true_positive if truth else self.false_positive
        no = self.false_negative if truth else self.true_negative
        trials = self.trials.get(truth, [])
        whole = len(trials) == yes + no
        return share(yes, yes + no, effective=effective_size(trials) if whole else None)

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
    trials: List[Tuple[Optional[int], str]] = field(default_factory=list)  # visit and outcome

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
            self.trials.append((attempt.visit, attempt.outcome))
        for observed in attempt.observed:
            self.sensors.setdefault(observed.fluent, Sensor()).add(observed, attempt.visit)
        self.durations.carried_out.append((attempt.metres or 0.0, attempt.duration_s))

    def interval(self, label: str) -> Interval:
        """The posterior of an outcome's probability."""
        total = sum(self.outcomes.values())
        trials = [(visit, outcome == label) for visit, outcome in self.trials]
        effective = effective_size(trials) if len(trials) == total else None
        return share(self.outcomes[label], total, len(self.outcomes), effective=effective)

    def intervals(self) -> Dict[str, Tuple[Interval, int]]:
        """What was learned by name, with the number of trials; what was not tried is left out."""
        found: Dict[str, Tuple[Interval, int]] = {}
        total = sum(self.outcomes.values())
        for label in self.outcomes if total else ():
            found[label] = (self.interval(label), total)
        for fluent, sensor in self.sensors.items():
            for truth, name in ((True, "where it is so"), (False, "where it is not")):
                if sensor.tells_value and not truth:
                    continue
                size = (
                    sensor.true_positive + sensor.false_negative
                    if truth
                    else sensor.false_positive + sensor.true_negative
                )
                if size:
                    what = "right" if sensor.tells_value else f"yes {name}"
                    found[f"{fluent}, {what}"] = (sensor.interval(truth), size)
        return found


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
        if self.dropped or (lines and lines[-1]):  # torn, if only before the end of its line
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


def joined(parts: Sequence[Sequence[Attempt]]) -> List[Attempt]:
    """The attempts of several training phases as those of one: their visits stay apart."""
    result: List[Attempt] = []
    for attempts in parts:
        first = 1 + max((attempt.visit or 0 for attempt in result), default=0)
        result += [
            attempt if attempt.visit is None else replace(attempt, visit=first + attempt.visit)
            for attempt in attempts
        ]
    return result


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
            None if content.get("visit") is None else int(content["visit"]),
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
    """Whether two estimates may be of the same number: the interval of their difference holds 0.

    Source: Newcombe (1998, Statistics in Medicine 17), method 10: stricter than intervals that overlap.
    """
    difference = first.mean - second.mean
    low = difference - math.hypot(first.mean - first.low, second.high - second.mean)
    high = difference + math.hypot(first.high - first.mean, second.mean - second.low)
    return low <= 0.0 <= high
