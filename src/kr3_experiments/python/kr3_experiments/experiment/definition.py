"""What an experiment is: its points, and what it makes of their rows."""
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Protocol, Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kr3_experiments.experiment.points import Point
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.statistics import Estimate, mean, share

METHOD_NAMES = {
    "pa": "PA",
    "pa_star": "PA*",
    "pomdp1": "POMDP-1 ahead",
    "pomdp1_online": "POMDP-1 online",
    "pomdp2": "POMDP-2",
    "hierarchical": "hierarchical POMDP-1",
}
COLOURS = ["#1f5fa8", "#c2410c", "#15803d", "#7e22ce", "#b8860b", "#475569", "#be123c", "#0e7490"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]
_MOST_INSIDE = 3  # curves whose names fit into a figure
_APART = 0.006  # of curves whose values coincide: shares of the width
_LEAST_TRIALS = 30  # of what has a share of a point's trials


@dataclass(frozen=True)
class Options:
    """What the command line says of a sweep."""

    quick: bool = False
    seed: int = (
        100_001  # of the first trial; no constant of the methods was tuned with seeds from here on
    )
    trials: int = 0  # a point; 0: as many as the protocol says
    learned: bool = False  # floors with the numbers that the simulated robot learned
    jobs: int = 1  # missions of `robot` at a time

    def seeds(self, full: int, quick: int, fraction: float = 1.0) -> "tuple[int, int]":
        """The first seed and the one after the last.

        @param fraction  of these trials, for what takes long: but a tenth of them at least, or 30
        """
        count = self.trials or (quick if self.quick else full)
        least = min(_LEAST_TRIALS, math.ceil(count / 10))
        return self.seed, self.seed + max(least, math.ceil(count * fraction))


@dataclass
class Table:
    """Cells are texts."""

    title: str
    header: Sequence[str]
    rows: List[Sequence[str]] = field(default_factory=list)


@dataclass
class Findings:
    """What an experiment found."""

    statements: List[str] = field(default_factory=list)  # a sentence each, with its figures
    tables: List[Table] = field(default_factory=list)
    figures: Dict[str, Figure] = field(default_factory=dict)  # name of the file without suffix


class Experiment(Protocol):
    """A sweep of trials and its analysis."""

    @property
    def name(self) -> str:
        """On the command line."""

    @property
    def title(self) -> str:
        """Of its section."""

    @property
    def claim(self) -> str:
        """What the paper says."""

    @property
    def protocol(self) -> str:
        """What is done here."""

    @property
    def labels(self) -> Mapping[str, Callable[[str], Any]]:
        """Columns that tell its points apart."""

    def points(self, options: Options) -> List[Point]:
        """What is to be run."""

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """@param rows  of all points, complete"""


def succeeded(row: Row) -> bool:
    """The ground truth satisfies the goal and the robot said so."""
    return bool(row["declared"] and row["goal_true"])


def success_of(rows: Sequence[Row]) -> Estimate:
    """Share of successes."""
    return share(sum(map(succeeded, rows)), len(rows))


def mean_of(rows: Sequence[Row], column: str) -> Estimate:
    """Of a numeric column, over all trials, failed ones included."""
    return mean([float(row[column]) for row in rows])


def false_declarations(rows: Sequence[Row]) -> int:
    """Trials in which the robot said that the goal holds, and it did not."""
    return sum(row["declared"] and not row["goal_true"] for row in rows)


def outcome_cells(rows: Sequence[Row], *means: str) -> List[str]:
    """Cells of a table: number of trials, success, false declarations, and means of columns."""
    return [
        str(len(rows)),
        success_of(rows).text(3),
        str(false_declarations(rows)),
        *(mean_of(rows, column).text(1) for column in means),
    ]


def select(rows: Sequence[Row], **values: Any) -> List[Row]:
    """Rows with these values."""
    return [row for row in rows if all(row[key] == value for key, value in values.items())]


def by_seed(rows: Sequence[Row]) -> Dict[int, Row]:
    """For pairing. @throws ValueError  two rows of a seed: they are of several points"""
    found = {row["seed"]: row for row in rows}
    if len(found) != len(rows):
        raise ValueError("rows of several points cannot be paired")
    return found


@dataclass(frozen=True)
class Curve:
    """A line of a figure, with the interval of each value."""

    name: str
    xs: Sequence[float]
    ys: Sequence[Estimate]


def _shifted(xs: Sequence[float], all_xs: Sequence[float], share: float, log: bool) -> List[float]:
    """To the side by a share of the width of an axis."""
    if not all_xs:
        return list(xs)
    first, last = min(all_xs), max(all_xs)
    return [x * (last / first) ** share if log else x + (last - first) * share for x in xs]


def plot(
    curves: Sequence[Curve], x_label: str, y_label: str, log_x: bool = False, log_y: bool = False
) -> Figure:
    """Values with their 95 % intervals."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    all_xs = sorted({x for curve in curves for x in curve.xs})
    for i, curve in enumerate(curves):
        values = [y.value for y in curve.ys]
        below = [max(0.0, y.value - y.low) for y in curve.ys]
        above = [max(0.0, y.high - y.value) for y in curve.ys]
        axes.errorbar(
            _shifted(curve.xs, all_xs, _APART * (i - (len(curves) - 1) / 2), log_x),
            values,
            yerr=[below, above],
            label=curve.name,
            color=COLOURS[i % len(COLOURS)],
            marker=MARKERS[i % len(MARKERS)],
            markersize=5,
            linewidth=1.6,
            capsize=3,
        )
    if log_x:
        axes.set_xscale("log")
        axes.set_xticks(all_xs, [f"{tick:g}" for tick in all_xs])
        axes.minorticks_off()
    if log_y:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(True, color="#e3e8ee")
    axes.spines[["top", "right"]].set_visible(False)
    if len(curves) > _MOST_INSIDE:
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    elif len(curves) > 1:
        axes.legend(frameon=False)
    return figure


def save_figures(figures: Mapping[str, Figure], folder: Path) -> None:
    """Each as NAME.png. @throws OSError"""
    for name, figure in figures.items():
        figure.savefig(folder / f"{name}.png")
