"""What counted budgets of POMDP-1 are worth in CPU seconds: the table that scripts/measure_budgets.py measured."""
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.definition import Table
from kr3_experiments.yaml_file import read_mapping


@dataclass(frozen=True)
class FloorBudgets:
    """Of one size, in the order of Budgets.seconds."""

    rooms: int
    cells: int  # of all rooms
    backups: Sequence[int]  # of a policy solved ahead; empty where the flat model is refused
    prospects: Sequence[int]  # of online planning, for each action of a mission
    decisions: float  # actions of a mission, which the seconds are shared among
    most_used: int  # prospects after which the first decision finds nothing better


@dataclass(frozen=True)
class Budgets:
    """The table."""

    machine: str
    commit: str
    seconds: Sequence[float]
    floors: Mapping[int, FloorBudgets]  # by rooms

    def table(self) -> Table:
        """For the report."""
        table = Table(
            f"Counted budgets and CPU seconds, measured on {self.machine} at {self.commit}",
            ["cells", "method", *(f"{seconds:g} s" for seconds in self.seconds), "used at most"],
        )
        for floor in self.floors.values():
            cells = str(floor.cells)
            if floor.backups:
                counts = [f"{count} backups" for count in floor.backups]
                table.rows.append([cells, "POMDP-1 ahead", *counts, ""])
            counts = [f"{count} prospects an action" for count in floor.prospects]
            table.rows.append([cells, "POMDP-1 online", *counts, str(floor.most_used)])
        return table


def load_budgets(path: Path) -> Budgets:
    """Read a table. @throws Kr3Error  it is missing or wrong; the message names the entry"""
    content = read_mapping(path, "found no table, expected machine, commit, seconds and floors")
    seconds = _numbers(path, content, "seconds", None)
    floors: Dict[int, FloorBudgets] = {}
    entries = content.get("floors")
    if not isinstance(entries, list) or not entries:
        raise Kr3Error(f"{path}: 'floors': found {entries!r}, expected a list of floors")
    for entry in entries:
        floor = FloorBudgets(
            rooms=_count(path, entry, "rooms"),
            cells=_count(path, entry, "cells"),
            backups=_numbers(path, entry, "backups", len(seconds), may_be_empty=True),
            prospects=_numbers(path, entry, "prospects", len(seconds)),
            decisions=float(entry.get("decisions", 0)),
            most_used=_count(path, entry, "most_used"),
        )
        floors[floor.rooms] = floor
    return Budgets(
        str(content.get("machine", "?")), str(content.get("commit", "?")), seconds, floors
    )


def _count(path: Path, entry: Any, key: str) -> int:
    found = entry.get(key) if isinstance(entry, dict) else None
    if not isinstance(found, int) or found < 1:
        raise Kr3Error(f"{path}: '{key}': found {found!r} in {entry!r}, expected a number from 1")
    return found


def _numbers(
    path: Path, entry: Mapping[str, Any], key: str, count: Optional[int], may_be_empty: bool = False
) -> List[Any]:
    found = entry.get(key, [])
    fits = isinstance(found, list) and all(
        isinstance(number, (int, float)) and number > 0 for number in found
    )
    if fits and (len(found) == count or (count is None and found) or (may_be_empty and not found)):
        return list(found)
    expected = "positive numbers" if count is None else f"{count} positive numbers"
    raise Kr3Error(f"{path}: '{key}': found {found!r} in {entry!r}, expected {expected}")
