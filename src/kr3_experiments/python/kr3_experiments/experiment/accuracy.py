"""H1: how often PA and POMDP-1 reach the goal as the number of cells grows."""
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple

from kr3_experiments.experiment.definition import (
    METHOD_NAMES,
    Curve,
    Findings,
    Options,
    Table,
    by_seed,
    outcome_cells,
    plot,
    select,
    succeeded,
    success_of,
)
from kr3_experiments.experiment.points import Floor, Point, TargetRule
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.statistics import mcnemar_p

_CELLS = 4  # a room
_ROOMS = [2, 4, 6, 9, 16, 25, 36, 64, 100]
_FLAT_ROOMS = [2, 4, 6, 9]  # beyond, the flat model is refused for its size (max_rows)
_FLAT_BACKUPS = [2_000, 20_000, 200_000]
_QUICK_ROOMS = [2, 4, 6]
_QUICK_BACKUPS = [2_000]
_NOISES = [1.0, 2.0]
_SIMILAR = 0.05


class Accuracy:
    """Success against cells."""

    name = "accuracy"
    title = "Success and the size of the floor"
    claim = "PA's success is clearly above POMDP-1's as cells grow (H1)."
    protocol = (
        "Four cells a room. The object asked for is in any room, all alike, and no default says where. Every policy of"
        " PA and of POMDP-1 has its budget in counted backups; POMDP-1 plans for the whole floor at once, ahead, with"
        " several budgets. Noise 1: slips .05, true positives .90, false positives .05, grasps .9; noise 2: twice the"
        " error rates. All methods meet the same worlds."
    )
    labels: Mapping[str, Callable[[str], Any]] = {
        "method": str,
        "rooms": int,
        "cells": int,
        "noise": float,
        "budget": int,
    }

    def points(self, options: Options) -> List[Point]:
        """PA everywhere, POMDP-1 where it can be built, at each budget."""
        points = []
        for noise in _NOISES[:1] if options.quick else _NOISES:
            for rooms in _QUICK_ROOMS if options.quick else _ROOMS:
                points.append(self._point(options, "pa", rooms, noise, 20_000))
                if rooms in _FLAT_ROOMS:
                    points += [
                        self._point(options, "pomdp1", rooms, noise, budget)
                        for budget in (_QUICK_BACKUPS if options.quick else _FLAT_BACKUPS)
                    ]
        return points

    @staticmethod
    def _point(options: Options, method: str, rooms: int, noise: float, budget: int) -> Point:
        work: Dict[str, Any] = (
            {"max_backups": budget}
            if method == "pa"
            else {"flat_backups": budget, "flat_planning": "ahead"}
        )
        job: Dict[str, Any] = {"method": method, "max_hl_actions": 40 + 4 * rooms, **work}
        return Point(
            label={
                "method": method,
                "rooms": rooms,
                "cells": rooms * _CELLS,
                "noise": noise,
                "budget": budget,
            },
            floor=Floor(rooms=rooms, cells=_CELLS, defaults=0, noise=noise),
            target=TargetRule(rooms=rooms),
            job=job,
            seeds=options.seeds(full=1000, quick=20),
        )

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Success by cells, for each noise and budget; PA against the best of POMDP-1 at the largest floor of both."""
        found = Findings()
        for noise in sorted({row["noise"] for row in rows}):
            here = select(rows, noise=noise)
            kinds = sorted({(row["method"], row["budget"]) for row in here})
            curves = [self._curve(here, method, budget) for method, budget in kinds]
            found.figures[f"accuracy_noise_{noise:g}"] = plot(
                curves, "cells", "share of successful missions", log_x=True
            )
            found.tables.append(self._table(here, noise, kinds))
            found.statements.append(self._statement(here, noise))
        return found

    @staticmethod
    def _curve(rows: Sequence[Row], method: str, budget: int) -> Curve:
        mine = select(rows, method=method, budget=budget)
        cells = sorted({row["cells"] for row in mine})
        name = METHOD_NAMES[method] + ("" if method == "pa" else f", {budget} backups")
        return Curve(name, cells, [success_of(select(mine, cells=count)) for count in cells])

    @staticmethod
    def _table(rows: Sequence[Row], noise: float, kinds: Sequence[Tuple[str, int]]) -> Table:
        table = Table(
            f"Noise {noise:g}",
            ["method", "backups", "cells", "trials", "success", "false", "LL actions", "time, s"],
        )
        for method, budget in kinds:
            mine = select(rows, method=method, budget=budget)
            for cells in sorted({row["cells"] for row in mine}):
                group = select(mine, cells=cells)
                table.rows.append(
                    [
                        METHOD_NAMES[method],
                        str(budget),
                        str(cells),
                        *outcome_cells(group, "ll_actions", "duration_s"),
                    ]
                )
        return table

    @staticmethod
    def _statement(rows: Sequence[Row], noise: float) -> str:
        flat = select(rows, method="pomdp1")
        cells = max(row["cells"] for row in flat)
        pa = by_seed(select(rows, method="pa", cells=cells))
        best = max(
            sorted({row["budget"] for row in flat}),
            key=lambda budget: success_of(select(flat, cells=cells, budget=budget)).value,
        )
        other = by_seed(select(flat, cells=cells, budget=best))
        seeds = sorted(pa.keys() & other.keys())
        p_value = mcnemar_p(
            [succeeded(pa[seed]) for seed in seeds], [succeeded(other[seed]) for seed in seeds]
        )
        first, second = success_of(list(pa.values())), success_of(list(other.values()))
        gap = first.value - second.value
        if gap > 0 and p_value < _SIMILAR:
            verdict = "as the paper says, PA is above POMDP-1"
        elif gap < 0 and p_value < _SIMILAR:
            verdict = "against the paper, POMDP-1 is above PA"
        else:
            verdict = "no difference is shown"
        return (
            f"Noise {noise:g}, {cells} cells: PA succeeds in {first.text(3)}, POMDP-1 with its best budget"
            f" ({best} backups) in {second.text(3)} of {len(seeds)} pairs: {verdict}"
            f" (McNemar's exact test, p = {p_value:.2g})."
        )
