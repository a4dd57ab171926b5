"""How long planning takes as rooms and objects grow: with all knowledge, with what is relevant, and in between.

Beside it, how long PA and POMDP-1 need until they act.
"""
import functools
import hashlib
import importlib.util
import itertools
import json
import resource
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Sequence

import numpy as np
from tqdm import tqdm

from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.definition import (
    Curve,
    Findings,
    Options,
    Table,
    mean_of,
    plot,
    select,
)
from kr3_experiments.experiment.points import (
    Configuration,
    Floor,
    Point,
    TargetRule,
    configurations,
)
from kr3_experiments.experiment.rows import Row, RowStore
from kr3_experiments.experiment.statistics import Estimate
from kr3_experiments.experiment.sweep import commit
from kr3_experiments.experiment.worker import TrialWorker, WorkerLost, trials_program
from kr3_experiments.programs import find_program

_ROOMS = [10, 20, 40, 80]
_OBJECTS = [10, 50, 200]
_QUICK_ROOMS = [10, 20]
_QUICK_OBJECTS = [10, 50]
_REPETITIONS = 10
_QUICK_REPETITIONS = 3
_KNOWLEDGE: Dict[str, List[str]] = {
    "all": ["--all-knowledge"],
    "relevant": [],
    "relevant + 20 %": ["--extra-share", "0.2"],
}
# A whole process of a mission that ends after its first action; the label names the method in the column `knowledge`.
_FIRST_ACTION: Dict[str, Dict[str, Any]] = {
    "PA": {"method": "pa"},
    "POMDP-1 online": {"method": "pomdp1", "flat_planning": "online"},
    "POMDP-1 ahead": {"method": "pomdp1", "flat_planning": "ahead", "flat_backups": 1},
}
_CELLS = 4  # a room
_USUAL = "r2"
_ONE_OBJECT = 1  # others do not matter to these methods
_RESULTS: Dict[str, Callable[[str], Any]] = {
    "config": str,
    "commit": str,
    "seed": int,
    "cpu_s": float,
    "steps": int,
}


class _Setting(NamedTuple):
    rooms: int
    objects: int
    knowledge: str

    @property
    def digest(self) -> str:
        """Hash of what the question depends on."""
        return hashlib.sha256(json.dumps(list(self)).encode()).hexdigest()[:12]


class PlanningTime:
    """CPU seconds of a whole process: one that grounds and plans once, and one that plans for its first action."""

    name = "planning_time"
    title = "Planning time"
    claim = (
        "Planning with relevant knowledge only is much faster than with all of it, and scales with rooms and objects"
        " (figure of rooms and objects)."
    )
    protocol = (
        "A textbook is to be fetched to a corner: four steps. Each figure is the CPU time of a whole process, cold. All"
        " knowledge; what is relevant to the goal; the same with 20 % of the rest, drawn at random. Beside it, on"
        " floors of four cells a room, the same of a mission up to its first action: PA (plan, POMDP of the first step"
        " and its policy), POMDP-1 online, and POMDP-1 ahead with its very first policy. Objects that are not asked"
        " for do not matter to POMDP-1."
    )
    labels: Mapping[str, Callable[[str], Any]] = {"rooms": int, "objects": int, "knowledge": str}

    def settings(self, options: Options) -> List[_Setting]:
        """What is to be measured."""
        rooms = _QUICK_ROOMS if options.quick else _ROOMS
        objects = _QUICK_OBJECTS if options.quick else _OBJECTS
        plans = itertools.product(rooms, objects, _KNOWLEDGE)
        first_actions = itertools.product(rooms, [_ONE_OBJECT], _FIRST_ACTION)
        return [_Setting(*values) for values in itertools.chain(plans, first_actions)]

    def measure(self, folder: Path, options: Options, run: bool = True) -> List[Row]:
        """Run what is missing, one process at a time: neighbours would disturb the figures.

        @throws Kr3Error  the planner fails, or the folder cannot be written
        """
        store = RowStore(folder, self.labels, _RESULTS)
        settings = self.settings(options)
        count = options.trials or (_QUICK_REPETITIONS if options.quick else _REPETITIONS)
        missing = [
            (setting, i)
            for setting in settings
            for i in range(count)
            if not store.has(setting.digest, i)
        ]
        if not run:
            return store.of([setting.digest for setting in settings])
        head = commit()
        generator = _rooms_domain()
        quiet = not sys.stderr.isatty()
        total = len(settings) * count
        with tqdm(
            total=total, initial=total - len(missing), unit="plan", mininterval=30 if quiet else 0.2
        ) as bar:
            for setting, repetition in missing:
                row: Row = dict(setting._asdict())
                row.update(config=setting.digest, commit=head, seed=repetition)
                if setting.knowledge in _FIRST_ACTION:
                    row.update(_act_once(folder / "floors", setting))
                else:
                    row.update(_plan_once(folder / "domains", generator, setting))
                store.add([row])
                bar.update()
        return store.of([setting.digest for setting in settings])

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Times by rooms for each number of objects, how much is saved, and when methods first act."""
        found = Findings()
        acting = [row for row in rows if row["knowledge"] in _FIRST_ACTION]
        acted = _acted(acting)
        rows = [row for row in rows if row["knowledge"] in _KNOWLEDGE]
        table = Table("CPU seconds", ["rooms", "objects", *_KNOWLEDGE])
        sizes = sorted({(row["rooms"], row["objects"]) for row in rows})
        for rooms, objects in sizes:
            groups = [
                select(rows, rooms=rooms, objects=objects, knowledge=name) for name in _KNOWLEDGE
            ]
            table.rows.append(
                [str(rooms), str(objects), *(mean_of(group, "cpu_s").text(4) for group in groups)]
            )
        found.tables.append(table)
        for objects in sorted({row["objects"] for row in rows}):
            here = select(rows, objects=objects)
            found.figures[f"planning_time_{objects}_objects"] = plot(
                [self._curve(here, name) for name in _KNOWLEDGE]
                + [self._curve(acted, name) for name in _FIRST_ACTION],
                f"rooms ({objects} objects)",
                "CPU time, s",
                log_x=True,
                log_y=True,
            )
        rooms, objects = sizes[-1]
        medians = {
            name: float(
                np.median(
                    [
                        row["cpu_s"]
                        for row in select(rows, rooms=rooms, objects=objects, knowledge=name)
                    ]
                )
            )
            for name in _KNOWLEDGE
        }
        ratio = medians["all"] / medians["relevant"]
        found.statements.append(
            f"{rooms} rooms and {objects} objects: all knowledge takes {medians['all']:.3f} s, relevant knowledge"
            f" {medians['relevant']:.4f} s, {ratio:.0f} times less; with 20 % more {medians['relevant + 20 %']:.3f} s"
            " (medians). " + ("As the paper says." if ratio > 1 else "Against the paper.")
        )
        if acting:
            found.tables.append(_first_actions(acting))
            found.statements += _who_acts_when(acting)
        return found

    @staticmethod
    def _curve(rows: Sequence[Row], knowledge: str) -> Curve:
        mine = select(rows, knowledge=knowledge)
        xs = sorted({row["rooms"] for row in mine})
        ys: List[Estimate] = [mean_of(select(mine, rooms=x), "cpu_s") for x in xs]
        return Curve(knowledge, xs, ys)


def _acted(rows: Sequence[Row]) -> List[Row]:
    """Those that did act: the others had no model of this size."""
    return [row for row in rows if row["steps"] > 0]


def _first_actions(rows: Sequence[Row]) -> Table:
    table = Table(
        "CPU seconds to the first action (four cells a room)", ["rooms", "cells", *_FIRST_ACTION]
    )
    for rooms in sorted({row["rooms"] for row in rows}):
        groups = [_acted(select(rows, rooms=rooms, knowledge=name)) for name in _FIRST_ACTION]
        times = [mean_of(group, "cpu_s").text(4) if group else "too large" for group in groups]
        table.rows.append([str(rooms), str(rooms * _CELLS), *times])
    return table


def _who_acts_when(rows: Sequence[Row]) -> List[str]:
    """Each method on the largest floor that it can plan for."""
    texts = []
    for name in _FIRST_ACTION:
        mine = _acted(select(rows, knowledge=name))
        if mine:
            rooms = max(row["rooms"] for row in mine)
            median = float(np.median([row["cpu_s"] for row in select(mine, rooms=rooms)]))
            texts.append(f"{name} after {median:.3f} s with {rooms} rooms")
    return [f"First action on the largest floor that can be planned for: {', '.join(texts)}."]


def _rooms_domain() -> ModuleType:
    """The generator of the reasoner's benchmark."""
    path = repository_root() / "src" / "kr3_reasoner" / "bench" / "rooms_domain.py"
    spec = importlib.util.spec_from_file_location("rooms_domain", path)
    if spec is None or spec.loader is None or not path.exists():
        raise Kr3Error(f"the generator '{path}' is missing")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its data classes look themselves up
    spec.loader.exec_module(module)
    return module


@functools.lru_cache(maxsize=None)
def _mission(folder: Path, setting: _Setting) -> Configuration:
    """One that ends after its first action; its floor is written once."""
    rooms = setting.rooms
    point = Point(
        label={},
        floor=Floor(rooms=rooms, cells=_CELLS),
        target=TargetRule(rooms=rooms, usual=_USUAL, share=1.0),
        job={**_FIRST_ACTION[setting.knowledge], "max_hl_actions": 1, "max_ll_actions": 1},
        seeds=(1, 2),
    )
    [configuration] = configurations([point], folder)
    return configuration


def _act_once(folder: Path, setting: _Setting) -> Dict[str, Any]:
    """CPU seconds of a mission that ends after its first action; no steps where no model of this size is built."""
    configuration = _mission(folder, setting)
    point = configuration.point
    trial = point.target.trial(1)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    worker = TrialWorker(trials_program())
    try:
        row = worker.run(configuration.digest, configuration.files, point.job, [trial])[0]
    except WorkerLost as error:
        raise Kr3Error(f"kr3_trials ends for {setting}: {error}") from error
    finally:
        worker.close()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"cpu_s": _cpu_s(before, after), "steps": row["ll_actions"]}


def _cpu_s(before: resource.struct_rusage, after: resource.struct_rusage) -> float:
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _plan_once(folder: Path, generator: ModuleType, setting: _Setting) -> Dict[str, Any]:
    """CPU seconds and length of the plan."""
    size = generator.Size(setting.rooms, setting.objects)
    here = folder / f"{setting.rooms}x{setting.objects}"
    domain, history = here / "domain.kr3", here / "history.kr3"
    if not history.exists():
        here.mkdir(parents=True, exist_ok=True)
        domain.write_text(generator.domain(size), encoding="utf-8")
        history.write_text(generator.start(size), encoding="utf-8")
    command = [
        find_program("kr3_reasoner", "reasoner_bench"),
        "plan",
        str(domain),
        str(history),
        generator.GOAL,
    ]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [*command, *_KNOWLEDGE[setting.knowledge]], capture_output=True, text=True, check=False
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise Kr3Error(f"reasoner_bench fails for {setting}: {done.stderr.strip()}")
    return {
        "cpu_s": _cpu_s(before, after),
        "steps": json.loads(done.stdout).get("steps", 0),
    }
