"""The training phase: how far learned models are from the truth, and what that costs."""
import math
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

import yaml

from kr3_experiments.experiment.definition import (
    Curve,
    Findings,
    Options,
    Table,
    by_seed,
    false_declarations,
    mean_of,
    plot,
    select,
    success_of,
)
from kr3_experiments.experiment.points import Floor, Point, TargetRule
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.statistics import Estimate, mean, share
from kr3_experiments.learning.abstract import attempts_in_abstract_world
from kr3_experiments.learning.counts import Attempt, count
from kr3_experiments.learning.model_error import model_error
from kr3_experiments.learning.session import conclude, load_lesson

_ROOMS = 4
_QUICK_ROOMS = 3
_NOISE = 2.0
_BACKUPS = 2_000
_SAMPLES = [3, 10, 30, 100, 300, 1000]
_QUICK_SAMPLES = [3, 30]
_TRAININGS = 10
_QUICK_TRAININGS = 3
_TRAINING_SEED = 500_000  # beyond the seeds of trials
_TRUE = "true"
_LEARNED = "learned"
_HAND_WRITTEN = "hand-written"
_COLUMNS = {"ll_actions": "low-level actions", "duration_s": "time of a mission, s"}


class Learning:
    """Model error and missions over the number of training samples."""

    name = "learning"
    title = "Learned models"
    claim = "T and O are learned in a training phase before the missions; the paper does not say what its size changes."
    protocol = (
        f"A floor of rooms of four cells whose errors are {_NOISE:g} times those of the hand-written models. The"
        " robot tries each low-level action N times (./kr3 learn --world abstract), what it looks for N times where it"
        f" is and N times where it is not, in {_TRAININGS} training phases ({_QUICK_TRAININGS} if quick), and plans"
        " with the means of the posteriors; PA then acts in the true world. The same missions with the true models,"
        " and with the hand-written ones that nobody learned. Model error: total variation between learned and true"
        " distributions, mean over actions (T) and over sensors and truths (O); Kullback-Leibler divergence of both."
        " Intervals of model errors are over training phases, of losses over missions and training phases. Durations"
        " are learned as well; the abstract world has none that vary."
    )
    labels: Mapping[str, Callable[[str], Any]] = {
        "models": str,
        "samples": int,
        "training": int,
        "error_t": float,
        "error_o": float,
        "divergence": float,
        "intervals": int,
        "covered": int,
    }

    def points(self, options: Options) -> List[Point]:
        """True and hand-written models, and each training phase at each number of samples."""
        samples = _QUICK_SAMPLES if options.quick else _SAMPLES
        rooms = _QUICK_ROOMS if options.quick else _ROOMS
        points = [self._point(options, rooms, label, text) for label, text in _untrained(rooms)]
        for training in range(_QUICK_TRAININGS if options.quick else _TRAININGS):
            points += [
                self._point(options, rooms, label, text)
                for label, text in _trained(rooms, tuple(samples), training)
            ]
        return points

    @staticmethod
    def _point(options: Options, rooms: int, label: Mapping[str, Any], models: str) -> Point:
        return Point(
            label=label,
            floor=Floor(rooms=rooms, defaults=0, noise=_NOISE),
            target=TargetRule(rooms=rooms),
            job={
                "method": "pa",
                "max_backups": _BACKUPS,
                "models": "robot.yaml",
                "world_models": "models.yaml",
            },
            seeds=options.seeds(full=200, quick=10),
            files={"robot.yaml": models},
        )

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Model error, and what missions lose against the true models, over N."""
        found = Findings()
        groups = Groups(rows)
        if groups.samples:
            found.figures["learning_error"] = plot(
                [
                    Curve(name, groups.samples, [groups.error(n, column) for n in groups.samples])
                    for name, column in (("T", "error_t"), ("O", "error_o"))
                ],
                "training samples of each action and truth",
                "total variation, learned to true",
                log_x=True,
            )
            for column, text in _COLUMNS.items():
                losses = {n: groups.loss(n, column) for n in groups.samples}
                known = {n: loss for n, loss in losses.items() if loss is not None}
                if known:
                    found.figures[f"learning_{column}"] = plot(
                        [Curve(text, list(known), list(known.values()))],
                        "training samples of each action and truth",
                        f"{text}, more than with the true models",
                        log_x=True,
                    )
        found.tables += [self._errors(groups), self._missions(groups)]
        found.statements += self._statements(groups)
        return found

    @staticmethod
    def _errors(groups: "Groups") -> Table:
        table = Table(
            "Model error",
            [
                "models",
                "N",
                "trainings",
                "T",
                "O",
                "divergence, nats",
                "intervals that hold the truth",
            ],
        )
        for n in groups.samples:
            cover = groups.coverage(n)
            table.rows.append(
                [
                    _LEARNED,
                    str(n),
                    str(len(groups.trainings(n))),
                    *(groups.error(n, column).text(4) for column in ("error_t", "error_o")),
                    groups.error(n, "divergence").text(4),
                    cover.text(3),
                ]
            )
        hand = groups.of(_HAND_WRITTEN)
        if hand:
            values = (f"{hand[0][column]:.4f}" for column in ("error_t", "error_o", "divergence"))
            table.rows.append([_HAND_WRITTEN, "-", "-", *values, "-"])
        return table

    @staticmethod
    def _missions(groups: "Groups") -> Table:
        table = Table(
            "Missions, and how they differ from those with the true models (pair by pair)",
            [
                *("models", "N", "trials", "success", "false", "LL actions", "time, s"),
                *("success, more", "LL actions, more", "time, more, s"),
            ],
        )
        for name, n in [(_TRUE, 0), (_HAND_WRITTEN, 0), *((_LEARNED, n) for n in groups.samples)]:
            mine = groups.of(name, n)
            if not mine:
                continue
            table.rows.append(
                [
                    name,
                    str(n) if n else "-",
                    str(len(mine)),
                    success_of(mine).text(3),
                    str(false_declarations(mine)),
                    *(mean_of(mine, column).text(1) for column in _COLUMNS),
                    *(
                        loss.text(3 if column == "success" else 1) if loss else "-"
                        for column in ("success", *_COLUMNS)
                        for loss in [None if name == _TRUE else groups.loss(n, column, name)]
                    ),
                ]
            )
        return table

    @staticmethod
    def _statements(groups: "Groups") -> List[str]:
        statements = []
        if groups.samples:
            first, last = groups.samples[0], groups.samples[-1]
            for kind, column in (("T", "error_t"), ("O", "error_o")):
                statements.append(
                    f"Model error of {kind}: {groups.error(first, column).text(3)} after N = {first},"
                    f" {groups.error(last, column).text(3)} after N = {last} samples"
                    f" ({len(groups.trainings(last))} training phases)."
                )
            every = [groups.coverage(n) for n in groups.samples]
            worst = min(every, key=lambda cover: cover.value)
            statements.append(
                f"Stated intervals of 95 % hold the true probability in {worst.text(3)} of the cases at the N where"
                " they do so least."
            )
        cases = [(_LEARNED, n) for n in groups.samples]
        if groups.of(_HAND_WRITTEN):
            cases.append((_HAND_WRITTEN, 0))
        for name, n in cases:
            more = groups.loss(n, "ll_actions", name)
            success = groups.loss(n, "success", name)
            if more is None or success is None:
                continue
            verdict = (
                "costs actions"
                if more.low > 0
                else "saves actions"
                if more.high < 0
                else "makes no visible difference"
            )
            wrong = false_declarations(groups.of(name, n))
            what = f"Learned from N = {n} samples" if name == _LEARNED else "Hand-written numbers"
            statements.append(
                f"{what}: {more.text(1)} low-level actions and {success.text(3)} of success more than with the true"
                f" models, {wrong} false declarations in {len(groups.of(name, n))} missions: this {verdict}."
            )
        return statements


class Groups:
    """Rows by models, samples and training phase."""

    def __init__(self, rows: Sequence[Row]):
        self._rows = rows
        self.samples = sorted({row["samples"] for row in rows if row["models"] == _LEARNED})
        self._true = by_seed(self.of(_TRUE))

    def of(self, models: str, samples: int = 0) -> List[Row]:
        """All trials."""
        return select(self._rows, models=models, samples=samples)

    def trainings(self, samples: int, models: str = _LEARNED) -> List[List[Row]]:
        """The trials of each training phase."""
        mine = self.of(models, samples)
        return [
            select(mine, training=number) for number in sorted({row["training"] for row in mine})
        ]

    def error(self, samples: int, column: str) -> Estimate:
        """Mean over training phases of what is never below 0."""
        found = mean([float(group[0][column]) for group in self.trainings(samples)])
        return Estimate(found.value, max(0.0, found.low), found.high)

    def coverage(self, samples: int) -> Estimate:
        """Share of stated intervals that hold the truth."""
        firsts = [group[0] for group in self.trainings(samples)]
        return share(sum(row["covered"] for row in firsts), sum(row["intervals"] for row in firsts))

    def loss(self, samples: int, column: str, models: str = _LEARNED) -> Optional[Estimate]:
        """How much more than with the true models, over the same seeds; None when there are no pairs.

        The interval adds what differs between missions, the chances of those with the true models included, and what
        differs between training phases: missions with the same models are not independent of each other.
        """
        groups = [by_seed(group) for group in self.trainings(samples, models)]
        seeds = sorted(self._true.keys() & set().union(*(group.keys() for group in groups)))
        if not seeds:
            return None
        by_mission, by_training = [], []
        for seed in seeds:
            values = [_value(group[seed], column) for group in groups if seed in group]
            by_mission.append(sum(values) / len(values) - _value(self._true[seed], column))
        for group in groups:
            values = [
                _value(group[seed], column) - _value(self._true[seed], column)
                for seed in seeds
                if seed in group
            ]
            by_training += [sum(values) / len(values)] if values else []
        missions = mean(by_mission)
        if len(by_training) < 2:
            return missions
        half = math.hypot(_half(missions), _half(mean(by_training)))
        return Estimate(missions.value, missions.value - half, missions.value + half)


def _half(estimate: Estimate) -> float:
    return estimate.high - estimate.value


def _value(row: Row, column: str) -> float:
    if column == "success":
        return float(row["declared"] and row["goal_true"])
    return float(row[column])


def _label(models: str, samples: int, training: int, **numbers: Any) -> Dict[str, Any]:
    label: Dict[str, Any] = {"models": models, "samples": samples, "training": training}
    label.update(error_t=0.0, error_o=0.0, divergence=0.0, intervals=0, covered=0)
    return {**label, **numbers}


def _text_of_models(rooms: int, noise: float) -> str:
    with tempfile.TemporaryDirectory(prefix="kr3_learning_") as name:
        Floor(rooms=rooms, defaults=0, noise=noise).write(Path(name))
        return (Path(name) / "models.yaml").read_text(encoding="utf-8")


@lru_cache(maxsize=8)
def _untrained(rooms: int) -> List[Tuple[Dict[str, Any], str]]:
    """Labels and texts of the models that nobody learned."""
    true, hand = _text_of_models(rooms, _NOISE), _text_of_models(rooms, 1.0)
    error = model_error(yaml.safe_load(true), yaml.safe_load(hand), {})
    numbers = {
        "error_t": error.transition_error,
        "error_o": error.observation_error,
        "divergence": error.divergence,
    }
    return [(_label(_TRUE, 0, 0), true), (_label(_HAND_WRITTEN, 0, 0, **numbers), hand)]


@lru_cache(maxsize=64)
def _trained(
    rooms: int, samples: Tuple[int, ...], training: int
) -> List[Tuple[Dict[str, Any], str]]:
    """Labels and texts of the models of one training phase, at each number of samples, each from the one before."""
    with tempfile.TemporaryDirectory(prefix="kr3_learning_") as name:
        folder = Path(name)
        Floor(rooms=rooms, defaults=0, noise=_NOISE).write(folder)
        attempts = attempts_in_abstract_world(
            folder, max(samples), _TRAINING_SEED + training, folder / "attempts.jsonl"
        )
        true = yaml.safe_load((folder / "models.yaml").read_text(encoding="utf-8"))
        # What the training phase starts from are the numbers that somebody wrote by hand.
        (folder / "models.yaml").write_text(_text_of_models(rooms, 1.0), encoding="utf-8")
        lesson = load_lesson(folder)
        laws = lesson.laws({})
        labels = {action: laws.labels(action) for action in lesson.entries}
        rounds = len(attempts) // max(samples)
        found = []
        for number in samples:
            some: Sequence[Attempt] = attempts[: number * rounds]
            output = folder / "learned.yaml"
            conclude(lesson, laws, some, output, [], classes=False)
            # Two training phases may count the same: their missions are different trials nevertheless.
            text = f"# Training phase {training + 1}, {number} samples.\n"
            text += _without_head(output.read_text(encoding="utf-8"))
            error = model_error(true, yaml.safe_load(text), count(some, labels))
            label = _label(
                _LEARNED,
                number,
                training + 1,
                error_t=error.transition_error,
                error_o=error.observation_error,
                divergence=error.divergence,
                intervals=error.intervals,
                covered=error.covered,
            )
            found.append((label, text))
        return found


def _without_head(text: str) -> str:
    """Without the comments, which say the day: a configuration is the same on another one."""
    return "".join(line + "\n" for line in text.splitlines() if not line.startswith("#"))
