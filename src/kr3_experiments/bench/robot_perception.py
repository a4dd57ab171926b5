"""The perception part of ./kr3 bench robot: a domain's detector on pictures that nobody has seen."""

import pathlib
import sys
import typing

if typing.TYPE_CHECKING:
    from bench_robot import Bench

ROOT = pathlib.Path(__file__).resolve().parents[3]
DOMAIN = "office"
MUGS = ("mug1", "mug2")  # of that domain
# Set: goals of precision and recall.
GOALS: dict[str, tuple[float, float] | None] = {
    "easy": (0.97, 0.95),
    "clutter": (0.97, 0.85),
    "rotated": (0.96, 0.93),
    "confusable": None,
    "home": None,
}
GOAL_MUGS_IN_CLUTTER = 0.75
GOAL_BRIER = 0.03
GOAL_MS = 30.0
# Seeds below were looked at while the detector was made.
SEEDS_FROM = 1000


def measure(bench: "Bench") -> None:
    """Sets rendered from the bench's seed, in rooms, lights and viewpoints of their own."""
    folder = ROOT / "domains" / DOMAIN
    seed = SEEDS_FROM + bench.seed
    pictures = bench.work / "pictures"
    size = 24 if bench.quick else 120
    bench.run(
        [
            sys.executable,
            str(ROOT / "src" / "kr3_perception" / "scripts" / "make_labelled_sets"),
            str(folder),
            str(pictures),
            "--sets",
            *GOALS,
            "--size",
            str(size),
            "--seed",
            str(seed),
            "--render-dataset",
            bench.program("kr3_sim_ode", "render_dataset"),
        ]
    )
    answer = bench.figures(
        "kr3_perception",
        "evaluate_detector",
        str(folder / "perception.yml.gz"),
        *(str(pictures / name) for name in GOALS),
    )
    for result in answer["sets"]:
        name = result["set"]
        goal = GOALS[name]
        params = {"pictures": result["images"], "seed": seed}
        for i, key in enumerate(("precision", "recall")):
            bench.add(
                f"detection {name}: {key}",
                result["all"][key],
                "share",
                goal=None if goal is None else goal[i],
                better="higher",
                params=params,
            )
        if name == "clutter":
            _add_mugs(bench, result, params)
        for of_class, score in sorted(result["classes"].items()):
            for key in ("precision", "recall"):
                bench.add(
                    f"detection {name}: {of_class} {key}",
                    score[key],
                    "share",
                    better="higher",
                    params=params,
                )
        bench.add(
            f"detection {name}: Brier score", result["brier"], "", goal=GOAL_BRIER, params=params
        )
        milliseconds = result["cpu_ms"]
        bench.add(
            f"detection {name}: 640x480", milliseconds["median"], "ms", goal=GOAL_MS, params=params
        )
        bench.add(f"detection {name}: 640x480, 95 %", milliseconds["p95"], "ms", params=params)


def _add_mugs(bench: "Bench", result: dict, params: dict) -> None:
    scores = [result["objects"][name] for name in MUGS if name in result["objects"]]
    right, missed = (sum(score[key] for score in scores) for key in ("right", "missed"))
    if right + missed:
        bench.add(
            "detection clutter: recall of mugs",
            right / (right + missed),
            "share",
            goal=GOAL_MUGS_IN_CLUTTER,
            better="higher",
            params={**params, "mugs": right + missed},
        )
