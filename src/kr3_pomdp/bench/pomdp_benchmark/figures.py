"""What was measured, beside its goal; as text and as JSON."""

import math
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Figure:
    """One measured number. `value` is None when the run did not get there in its time.

    better: "lower" or "higher", or "" where the figure has no goal
    """

    name: str
    value: float | None
    unit: str = ""
    goal: float | None = None
    better: str = ""
    params: dict = field(default_factory=dict)
    runs: list[float] = field(default_factory=list)

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None without one."""
        if self.goal is None or not self.better:
            return None
        if self.value is None:
            return False
        return self.value <= self.goal if self.better == "lower" else self.value >= self.goal

    def as_json(self) -> dict:
        return {
            "name": self.name,
            "value": self.value,
            "unit": self.unit,
            "goal": self.goal,
            "better": self.better,
            "met": self.met,
            "params": self.params,
            "runs": self.runs,
        }

    def __str__(self) -> str:
        about = " ".join(f"{key}={value}" for key, value in self.params.items())
        value = (
            "not reached" if self.value is None else f"{rounded(self.value)} {self.unit}".strip()
        )
        if self.met is None:
            return f"  {self.name:<44} {about:<30} {value}"
        relation = "<=" if self.better == "lower" else ">="
        verdict = "met" if self.met else "NOT MET"
        return f"  {self.name:<44} {about:<30} {value:<16} {verdict}, goal {relation} {rounded(self.goal)}"


def rounded(value: float) -> str:
    """Four digits that count."""
    if value == 0.0 or not math.isfinite(value):
        return str(value)
    digits = max(0, 3 - math.floor(math.log10(abs(value))))
    return f"{value:.{digits}f}"


def geometric_mean(values: list[float]) -> float:
    """@raises ValueError  there are none, or one is not positive"""
    if not values or min(values) <= 0.0:
        raise ValueError(f"found {values}, expected positive numbers")
    return math.exp(sum(math.log(value) for value in values) / len(values))


def summary(figures: list[Figure]) -> str:
    """How many goals are met, and those that are not."""
    with_goal = [figure for figure in figures if figure.met is not None]
    missed = [figure for figure in with_goal if not figure.met]
    lines = [f"{len(with_goal) - len(missed)} of {len(with_goal)} goals met in this run"]
    return "\n".join(lines + [str(figure) for figure in missed])
