"""H2: what defaults save, as the floor grows and as fewer objects obey them."""
from typing import Any, Callable, List, Mapping, Sequence, Tuple

from kr3_experiments.experiment.definition import (
    METHOD_NAMES,
    Curve,
    Findings,
    Options,
    Table,
    by_seed,
    mean_of,
    outcome_cells,
    plot,
    select,
)
from kr3_experiments.experiment.points import Floor, Point, TargetRule
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.statistics import p_text, paired

_USUAL = "r2"  # where the first default of a floor says that objects are
_HEADLINE = 0.8
_ROOMS = [4, 6, 9, 12, 16, 25, 36, 49, 64, 100]
_SHARES = [0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0]
_SHARE_ROOMS = 9
_QUICK_ROOMS = [4, 6]
_QUICK_SHARES = [0.0, 0.8]
_METHODS = ["pa", "pa_star"]
_BACKUPS = 1000  # a policy: in a room of four cells more hardly earn (docs/coupling.md)


class Defaults:
    """PA against PA*, which knows no defaults."""

    name = "defaults"
    title = "What defaults save"
    claim = "Defaults cut the number of actions (H2)."
    protocol = (
        "Four cells a room. An object is where its first default says with probability q, else in any other room, all"
        " alike; three defaults in a chain. The robot starts in any room, all alike. Floors of several sizes at"
        f" q = {_HEADLINE:g}, and several q at {_SHARE_ROOMS} rooms. PA* has the same description without its defaults."
        f" The same worlds for both. A policy has {_BACKUPS} backups at most."
    )
    labels: Mapping[str, Callable[[str], Any]] = {"method": str, "rooms": int, "share": float}

    def points(self, options: Options) -> List[Point]:
        """Sizes at the headline share, and shares at one size; small floors first."""
        sizes = _QUICK_ROOMS if options.quick else _ROOMS
        shares = _QUICK_SHARES if options.quick else _SHARES
        places = _QUICK_ROOMS[-1] if options.quick else _SHARE_ROOMS
        settings = [(rooms, _HEADLINE) for rooms in sizes]
        settings += [(places, share) for share in shares if (places, share) not in settings]
        return _points(options, sorted(settings))

    @staticmethod
    def headline(options: Options, sizes: Sequence[int]) -> List[Point]:
        """The points of these sizes at the headline share."""
        return _points(options, [(rooms, _HEADLINE) for rooms in sizes])

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Actions and time against rooms and against q."""
        found = Findings()
        headline = select(rows, share=_HEADLINE)
        places = _QUICK_ROOMS[-1] if options.quick else _SHARE_ROOMS
        one_size = select(rows, rooms=places)
        for name, group, key, label in (
            ("rooms", headline, "rooms", f"rooms (q = {_HEADLINE:g})"),
            (
                "share",
                one_size,
                "share",
                f"share q of objects that obey their default ({places} rooms)",
            ),
        ):
            for column, text in (
                ("hl_actions", "high-level actions"),
                ("duration_s", "time of a mission, s"),
            ):
                found.figures[f"defaults_{column}_by_{name}"] = plot(
                    [self._curve(group, method, key, column) for method in _METHODS],
                    label,
                    text,
                    log_x=key == "rooms",
                )
        found.tables.append(self._table(rows))
        for rooms in _sizes(headline):
            found.statements += self._statement(headline, rooms)
        return found

    @staticmethod
    def _curve(rows: Sequence[Row], method: str, key: str, column: str) -> Curve:
        mine = select(rows, method=method)
        xs = sorted({row[key] for row in mine})
        ys = [mean_of([row for row in mine if row[key] == x], column) for x in xs]
        return Curve(METHOD_NAMES[method], xs, ys)

    @staticmethod
    def _table(rows: Sequence[Row]) -> Table:
        table = Table(
            "All points",
            [
                "rooms",
                "q",
                "method",
                "trials",
                "success",
                "false",
                "HL actions",
                "LL actions",
                "time, s",
            ],
        )
        for rooms, share, method in sorted(
            {(row["rooms"], row["share"], row["method"]) for row in rows}
        ):
            group = select(rows, rooms=rooms, share=share, method=method)
            table.rows.append(
                [
                    str(rooms),
                    f"{share:g}",
                    METHOD_NAMES[method],
                    *outcome_cells(group, "hl_actions", "ll_actions", "duration_s"),
                ]
            )
        return table

    @staticmethod
    def _statement(rows: Sequence[Row], rooms: int) -> List[str]:
        """Nothing with fewer than two pairs."""
        here = select(rows, rooms=rooms)
        first, second = (by_seed(select(here, method=method)) for method in _METHODS)
        seeds = sorted(first.keys() & second.keys())
        if len(seeds) < 2:
            return []
        result = paired(
            [float(first[seed]["hl_actions"]) for seed in seeds],
            [float(second[seed]["hl_actions"]) for seed in seeds],
        )
        verdict = (
            "defaults cut actions, as the paper says"
            if result.ratio.high < 1
            else "against the paper, defaults cost actions"
            if result.ratio.low > 1
            else "no difference is shown"
        )
        return [
            f"{rooms} rooms, q = {_HEADLINE:g}: PA takes {result.ratio.text()} times the high-level actions of PA*"
            f" over {result.pairs} pairs (Wilcoxon {p_text(result.wilcoxon_p)}): {verdict}."
        ]


def _points(options: Options, settings: Sequence[Tuple[int, float]]) -> List[Point]:
    """@param settings  rooms and shares"""
    return [
        Point(
            label={"method": method, "rooms": rooms, "share": share},
            floor=Floor(rooms=rooms),
            target=TargetRule(rooms=rooms, usual=_USUAL, share=share, start="loc(rob1)"),
            job={
                "method": method,
                "max_hl_actions": 40 + 4 * rooms,
                "max_backups": _BACKUPS,
            },
            seeds=options.seeds(full=10_000, quick=20),
        )
        for rooms, share in settings
        for method in _METHODS
    ]


def _sizes(rows: Sequence[Row]) -> List[int]:
    return sorted({row["rooms"] for row in rows})
