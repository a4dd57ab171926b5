"""H2: how much POMDP-2 depends on the probability that it gives to defaults."""
from typing import Any, Callable, Dict, List, Mapping, Sequence

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
    success_of,
)
from kr3_experiments.experiment.points import Floor, Point, TargetRule
from kr3_experiments.experiment.rows import Row
from kr3_experiments.experiment.statistics import p_text, paired

_USUAL = "r2"
_ROOMS = 4
_BIASES = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.99]
_QUICK_BIASES = [0.5, 0.85, 0.99]
_TARGETS = {"normal": 1.0, "exceptional": 0.0}  # share that obeys the default
_NO_BIAS = 0.0  # PA has none


class DefaultBias:
    """PA against POMDP-2 over p."""

    name = "default_bias"
    title = "Defaults as probabilities"
    claim = "POMDP-2's result depends on p, the probability of what defaults say, and on whether the object obeys (H2)."
    protocol = (
        f"{_ROOMS} rooms of four cells. POMDP-2 starts with probability p where the first default says, p of the rest"
        " where the second says, and so on. Objects that obey (normal) and objects in any other room (exceptional)."
        " PA knows the same defaults and has no p. The same worlds for all."
    )
    labels: Mapping[str, Callable[[str], Any]] = {"method": str, "bias": float, "target": str}

    def points(self, options: Options) -> List[Point]:
        """PA once, POMDP-2 for each p, for both kinds of target."""
        biases = _QUICK_BIASES if options.quick else _BIASES
        return [
            self._point(options, method, bias, target)
            for target in _TARGETS
            for method, bias in [("pa", _NO_BIAS), *(("pomdp2", bias) for bias in biases)]
        ]

    @staticmethod
    def _point(options: Options, method: str, bias: float, target: str) -> Point:
        job: Dict[str, Any] = {"method": method}
        if method == "pomdp2":
            job.update(bias=bias, flat_planning="ahead", flat_backups=20_000)
        return Point(
            label={"method": method, "bias": bias, "target": target},
            floor=Floor(rooms=_ROOMS),
            target=TargetRule(rooms=_ROOMS, usual=_USUAL, share=_TARGETS[target]),
            job=job,
            seeds=options.seeds(full=1000, quick=20),
        )

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Time and success over p."""
        found = Findings()
        for column, text in (("duration_s", "time of a mission, s"), ("success", "success")):
            found.figures[f"default_bias_{column}"] = plot(
                [
                    self._curve(rows, method, target, column)
                    for method in ("pa", "pomdp2")
                    for target in _TARGETS
                ],
                "probability p of what a default says",
                text,
            )
        table = Table(
            "All points",
            ["method", "p", "target", "trials", "success", "false", "LL actions", "time, s"],
        )
        for method, bias, target in sorted(
            {(row["method"], row["bias"], row["target"]) for row in rows}
        ):
            group = select(rows, method=method, bias=bias, target=target)
            table.rows.append(
                [
                    METHOD_NAMES[method],
                    "-" if method == "pa" else f"{bias:g}",
                    target,
                    *outcome_cells(group, "ll_actions", "duration_s"),
                ]
            )
        found.tables.append(table)
        for target in _TARGETS:
            found.statements += self._statement(rows, target)
        return found

    @staticmethod
    def _curve(rows: Sequence[Row], method: str, target: str, column: str) -> Curve:
        mine = select(rows, method=method, target=target)
        biases = sorted({row["bias"] for row in rows if row["method"] == "pomdp2"})

        def value(group: Sequence[Row]) -> Any:
            return success_of(group) if column == "success" else mean_of(group, column)

        name = f"{METHOD_NAMES[method]}, {target}"
        if not mine:
            return Curve(name, [], [])
        if method == "pa":
            return Curve(name, biases, [value(mine)] * len(biases))
        groups = {bias: select(mine, bias=bias) for bias in biases}
        there = [bias for bias in biases if groups[bias]]
        return Curve(name, there, [value(groups[bias]) for bias in there])

    @staticmethod
    def _statement(rows: Sequence[Row], target: str) -> List[str]:
        """Nothing with fewer than four seeds that every method and p had.

        Half of them choose the best and the worst p, which are compared on the other half. Of those p that cost success
        none is the best: a mission that ends early with a wrong declaration is short.
        """
        pa = by_seed(select(rows, method="pa", target=target))
        flat = select(rows, method="pomdp2", target=target)
        biases = sorted({row["bias"] for row in flat})
        groups = {bias: by_seed(select(flat, bias=bias)) for bias in biases}
        seeds = sorted(set(pa).intersection(*groups.values())) if groups else []
        if len(seeds) < 4:
            return []
        choosing, compared = seeds[::2], seeds[1::2]

        def times(group: Mapping[int, Row], some: Sequence[int]) -> List[float]:
            return [float(group[seed]["duration_s"]) for seed in some]

        reached = {bias: success_of([groups[bias][seed] for seed in choosing]) for bias in biases}
        least = max(estimate.low for estimate in reached.values())
        best = min(
            [bias for bias in biases if reached[bias].high >= least],
            key=lambda bias: sum(times(groups[bias], choosing)),
        )
        worst = max(biases, key=lambda bias: sum(times(groups[bias], choosing)))
        result = paired(times(pa, compared), times(groups[best], compared))
        spread = paired(times(groups[worst], compared), times(groups[best], compared))
        depends = "depends on p" if spread.ratio.low > 1 else "does not visibly depend on p"
        successes = {bias: success_of(list(groups[bias].values())) for bias in biases}
        lowest = min(biases, key=lambda bias: successes[bias].value)
        highest = max(biases, key=lambda bias: successes[bias].value)
        return [
            f"{target.capitalize()} targets: POMDP-2 is fastest at p = {best:g} and slowest at p = {worst:g}, by"
            f" {spread.ratio.text()}: it {depends}. PA takes {result.ratio.text()} times as long as POMDP-2 at its best"
            f" p (paired t-test {p_text(result.t_p)}, {result.pairs} pairs).",
            f"{target.capitalize()} targets: POMDP-2 succeeds in {successes[lowest].text(3)} at p = {lowest:g} and in"
            f" {successes[highest].text(3)} at p = {highest:g}, PA in {success_of(list(pa.values())).text(3)}.",
        ]
