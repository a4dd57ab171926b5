"""Robot trials: paired missions on the whole ROS stack in the simulated buildings."""
import hashlib
import json
import random
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

from tqdm import tqdm

from kr3_experiments.bringup import package_config
from kr3_experiments.domain import Domain, load_domain, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.definition import (
    METHOD_NAMES,
    Findings,
    Options,
    Table,
    by_seed,
    mean_of,
    select,
    share,
)
from kr3_experiments.experiment.rows import Row, RowStore, truth_cell
from kr3_experiments.experiment.statistics import Paired, mcnemar_p, paired
from kr3_experiments.experiment.sweep import commit

_DOMAINS = ["floor_a", "floor_b"]
_PAIRS = 25  # a building
_QUICK_PAIRS = 3
_ORACLE = "oracle"
_METHODS = ["pa", "hierarchical", _ORACLE]
_WALL_LIMIT_S = 1500.0
_PAPER_RATIO = 1.64
_NO_MISSION = "the mission did not run"
_RESULTS: Dict[str, Callable[[str], Any]] = {
    "config": str,
    "commit": str,
    "seed": int,
    "truth": str,
    "success": truth_cell,
    "declared": truth_cell,
    "hl_actions": int,
    "ll_actions": int,
    "duration_s": float,
    "contacts": int,
    "reason": str,
}


@dataclass(frozen=True)
class _Setting:
    """A method in a building."""

    domain: Domain
    method: str

    @property
    def digest(self) -> str:
        """Hash of what a mission depends on besides its seed and the programs: the domain and the stack file."""
        content = hashlib.sha256(self.method.encode())
        for file in [*sorted(self.domain.folder.iterdir()), package_config("stack.yaml")]:
            if file.is_file():
                content.update(file.name.encode() + b"\0" + file.read_bytes())
        return content.hexdigest()[:12]

    def target_at(self, seed: int) -> str:
        """Where the object is in the mission with this seed, the same for every method."""
        return random.Random(seed).choice(self.domain.target.may_be_at)


class Robot:
    """PA, the hierarchical POMDP and an oracle, mission by mission in the same worlds."""

    name = "robot"
    title = "Robot trials"
    claim = f"POMDP-1 takes {_PAPER_RATIO} times as long as PA on the robot (39 % less time, p = 0.0023)."
    protocol = (
        "Whole missions: simulator, navigation, camera, detection, executive, each a process. The object is in a place"
        " drawn from those that the scenario names; world and noise have the same seed for every method. The oracle is"
        " PA that is told the place. Missions that fail count with the time that they took; the ground truth decides."
    )
    labels: Mapping[str, Callable[[str], Any]] = {"building": str, "method": str}

    def settings(self) -> List[_Setting]:
        """@throws Kr3Error  a building has no map or no detector's model yet"""
        domains = [load_domain(name, repository_root()) for name in _DOMAINS]
        for domain in domains:
            domain.require_map()
            domain.require_model()
        return [_Setting(domain, method) for domain in domains for method in _METHODS]

    def measure(self, folder: Path, options: Options, run: bool = True) -> List[Row]:
        """Run the missions that are missing, one at a time, pair by pair: all methods meet the same machine."""
        store = RowStore(folder, self.labels, _RESULTS)
        settings = self.settings()
        seeds = range(*options.seeds(full=_PAIRS, quick=_QUICK_PAIRS))
        missing = [
            (setting, seed)
            for seed in seeds
            for setting in settings
            if not store.has(setting.digest, seed)
        ]
        total = len(settings) * len(seeds)
        head = commit()
        if run:
            with tqdm(
                total=total, initial=total - len(missing), unit="mission", mininterval=1
            ) as bar:
                for setting, seed in missing:
                    store.add([_mission(setting, seed, head)])
                    bar.update()
        return [
            row
            for row in store.of([setting.digest for setting in settings])
            if row["seed"] in seeds
        ]

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Ratios of times with their intervals and tests; every mission that failed."""
        found = Findings()
        table = Table(
            "Missions",
            ["building", "method", "missions", "success", "time, s", "HL actions", "contacts"],
        )
        for building, method in sorted({(row["building"], row["method"]) for row in rows}):
            group = select(rows, building=building, method=method)
            table.rows.append(
                [
                    building,
                    _name(method),
                    str(len(group)),
                    share(sum(row["success"] for row in group), len(group)).text(3),
                    mean_of(group, "duration_s").text(1),
                    mean_of(group, "hl_actions").text(1),
                    str(sum(row["contacts"] for row in group)),
                ]
            )
        found.tables.append(table)
        hierarchical = _compare(rows, "hierarchical", "pa")
        if hierarchical:
            found.statements.append(f"{hierarchical} The paper has {_PAPER_RATIO}.")
        oracle = _compare(rows, "pa", _ORACLE)
        if oracle:
            found.statements.append(f"{oracle} What not knowing the place costs; the goal is 1.3.")
        failed = Table("Missions that failed", ["building", "method", "seed", "truth", "why"])
        for row in rows:
            if not row["success"]:
                failed.rows.append(
                    [
                        row["building"],
                        _name(row["method"]),
                        str(row["seed"]),
                        row["truth"],
                        row["reason"],
                    ]
                )
        found.statements.append(f"{len(failed.rows)} of {len(rows)} missions failed.")
        if failed.rows:
            found.tables.append(failed)
        return found


def _name(method: str) -> str:
    return METHOD_NAMES.get(method, method)


def _pairs(rows: Sequence[Row], first: str, second: str) -> Tuple[List[Row], List[Row]]:
    """The missions that both methods had, of all buildings."""
    ones: List[Row] = []
    others: List[Row] = []
    for building in sorted({row["building"] for row in rows}):
        here = by_seed(select(rows, building=building, method=first))
        there = by_seed(select(rows, building=building, method=second))
        for seed in sorted(here.keys() & there.keys()):
            ones.append(here[seed])
            others.append(there[seed])
    return ones, others


def times_of_pairs(rows: Sequence[Row], first: str, second: str) -> Optional[Paired]:
    """Times of one method against another's; None with fewer than two pairs."""
    ones, others = _pairs(rows, first, second)
    if len(ones) < 2:
        return None
    return paired([row["duration_s"] for row in ones], [row["duration_s"] for row in others])


def _compare(rows: Sequence[Row], first: str, second: str) -> Optional[str]:
    """In words."""
    result = times_of_pairs(rows, first, second)
    if result is None:
        return None
    ones, others = _pairs(rows, first, second)
    success_p = mcnemar_p([row["success"] for row in ones], [row["success"] for row in others])
    return (
        f"{_name(first)} takes {result.ratio.text()} times as long as {_name(second)} over {result.pairs} pairs"
        f" (paired t-test p = {result.t_p:.2g}, Wilcoxon p = {result.wilcoxon_p:.2g}; success by McNemar p ="
        f" {success_p:.2g})."
    )


def _mission(setting: _Setting, seed: int, head: str) -> Row:
    """One mission as `./kr3 demo` runs it."""
    row: Row = {
        "building": setting.domain.name,
        "method": setting.method,
        "config": setting.digest,
        "commit": head,
        "seed": seed,
        "truth": setting.target_at(seed),
    }
    oracle = setting.method == _ORACLE
    with tempfile.TemporaryDirectory(prefix="kr3_robot_") as folder:
        command = ["rosrun", "kr3_experiments", "kr3_cli", "demo", "--no-bag"]
        command += ["--domain", setting.domain.name, "--seed", str(seed)]
        command += ["--target-at", str(row["truth"]), "--run-dir", folder]
        command += ["--method", "pa" if oracle else setting.method, *["--told"] * oracle]
        command += ["--time-limit", str(_WALL_LIMIT_S)]
        done = subprocess.run(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False
        )
        summary = _summary(Path(folder) / "summary.json")
    if done.returncode < 0 or done.returncode >= 128:
        raise Kr3Error("a mission was ended by a signal")
    if summary is None:
        words = done.stderr.strip().splitlines()
        row.update(success=False, declared=False, hl_actions=0, ll_actions=0, contacts=0)
        row.update(duration_s=_WALL_LIMIT_S, reason=f"{_NO_MISSION}: {words[-1] if words else ''}")
        print(f"  {row['building']}, {seed}: {row['reason']}", file=sys.stderr)
        return row
    row.update(
        success=summary["success"],
        declared=summary["declared"],
        hl_actions=summary["high_level_actions"],
        ll_actions=summary["low_level_actions"],
        duration_s=summary["mission_simulated_s"],
        contacts=summary["robot_contacts"],
        reason=summary["reason"],
    )
    return row


def _summary(file: Path) -> Optional[Dict[str, Any]]:
    try:
        return dict(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None
