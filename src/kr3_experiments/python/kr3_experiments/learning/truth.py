"""The ground truth of the training phase: fluents of the low level from where bodies are. Knows no ROS.

`learning.yaml` in the domain's folder says how:

    robot: rob1                      # the name that the laws have for the robot
    truth:
      loc(X): {cell_of: X}           # the cell in which the body is, of the robot and of what lies around
      in_hand(R, X): {held: X}       # whether the gripper holds it
"""
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.laws import ground
from kr3_experiments.yaml_file import read_mapping

Position = Tuple[float, float]  # m, map frame


@dataclass(frozen=True)
class CellArea:
    """A component of a place, as the navigator has it."""

    name: str
    whole: str
    centre: Position
    size: Position

    def distance(self, position: Position) -> float:
        """0 inside, else the distance to the border along the worse axis, m."""
        return max(0.0, *(abs(p - c) - s / 2 for p, c, s in zip(position, self.centre, self.size)))


@dataclass(frozen=True)
class Snapshot:
    """What the simulator says at one time."""

    positions: Mapping[str, Position]  # of bodies, the robot under its own name
    held: str  # name, or empty


class Truth:
    """Turns snapshots into values of fluents. @throws Kr3Error  the file is missing or malformed"""

    def __init__(self, path: Path):
        if not path.exists():
            raise Kr3Error(
                f"{path}: there is no such file; it says how ground truth becomes fluents"
            )
        content = read_mapping(path, "expected the keys 'robot' and 'truth'")
        if set(content) != {"robot", "truth"}:
            raise Kr3Error(f"{path}: expected the keys 'robot' and 'truth'")
        self.robot = str(content["robot"])
        self._rules: List[Tuple[str, List[str], str, str]] = []
        if not isinstance(content["truth"], dict) or not content["truth"]:
            raise Kr3Error(f"{path}: 'truth' is empty, expected fluents as 'f(X): {{cell_of: X}}'")
        for fluent, rule in content["truth"].items():
            head = re.fullmatch(r"(\w+)\(([^()]*)\)", str(fluent))
            kind, variable = (
                next(iter(rule.items())) if isinstance(rule, dict) and len(rule) == 1 else ("", "")
            )
            parameters = [item.strip() for item in head.group(2).split(",")] if head else []
            if head is None or kind not in ("cell_of", "held") or variable not in parameters:
                raise Kr3Error(
                    f"{path}: found '{fluent}: {rule}', expected 'f(X): {{cell_of: X}}' or 'f(R, X): {{held: X}}'"
                )
            self._rules.append((head.group(1), parameters, kind, str(variable)))

    @property
    def fluents(self) -> List[str]:
        """Names of the fluents whose truth is known."""
        return [name for name, _, _, _ in self._rules]

    def state(self, snapshot: Snapshot, cells: Sequence[CellArea]) -> Dict[str, "str | bool"]:
        """Values of the ground fluents."""
        values: Dict[str, "str | bool"] = {}
        for name, parameters, kind, variable in self._rules:
            for body, position in snapshot.positions.items():
                arguments = [body if item == variable else self.robot for item in parameters]
                if kind == "cell_of":
                    cell = min(cells, key=lambda area: area.distance(position))
                    values[ground(name, arguments)] = cell.name
                elif body != self.robot:
                    values[ground(name, arguments)] = snapshot.held == body
        return values


def components(cells: Sequence[CellArea]) -> Dict[str, List[str]]:
    """Whole -> its cells."""
    result: Dict[str, List[str]] = {}
    for cell in cells:
        result.setdefault(cell.whole, []).append(cell.name)
    return result


def told(truth: Mapping[str, "str | bool"], fluent: str, value: Optional[str]) -> bool:
    """Whether a ground fluent has a value, or is true. @throws Kr3Error  its truth is not known"""
    if fluent not in truth:
        raise Kr3Error(f"learning.yaml does not say what is true of '{fluent}'")
    return truth[fluent] is True if value is None else truth[fluent] == value
