"""How long planning takes as rooms and objects grow: with all knowledge, with what is relevant, and in between."""
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
from kr3_experiments.experiment.rows import Row, RowStore
from kr3_experiments.experiment.statistics import Estimate
from kr3_experiments.experiment.sweep import commit
from kr3_experiments.experiment.worker import find_program

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
    """CPU seconds of a whole process that reads domain and history, grounds and plans once."""

    name = "planning_time"
    title = "Planning time"
    claim = (
        "Planning with relevant knowledge only is much faster than with all of it, and scales with rooms and objects"
        " (figure of rooms and objects)."
    )
    protocol = (
        "A textbook is to be fetched to a corner: four steps. Each figure is the CPU time of a whole process, cold. All"
        " knowledge; what is relevant to the goal; the same with 20 % of the rest, drawn at random."
    )
    labels: Mapping[str, Callable[[str], Any]] = {"rooms": int, "objects": int, "knowledge": str}

    def settings(self, options: Options) -> List[_Setting]:
        """What is to be measured."""
        rooms = _QUICK_ROOMS if options.quick else _ROOMS
        objects = _QUICK_OBJECTS if options.quick else _OBJECTS
        return [_Setting(*values) for values in itertools.product(rooms, objects, _KNOWLEDGE)]

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
                row.update(_plan_once(folder / "domains", generator, setting))
                store.add([row])
                bar.update()
        return store.of([setting.digest for setting in settings])

    def findings(self, rows: Sequence[Row], options: Options) -> Findings:
        """Times by rooms for each number of objects, and how much is saved."""
        found = Findings()
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
                [self._curve(here, name) for name in _KNOWLEDGE],
                f"rooms ({objects} objects)",
                "CPU time, s",
                log_x=True,
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
        return found

    @staticmethod
    def _curve(rows: Sequence[Row], knowledge: str) -> Curve:
        mine = select(rows, knowledge=knowledge)
        xs = sorted({row["rooms"] for row in mine})
        ys: List[Estimate] = [mean_of(select(mine, rooms=x), "cpu_s") for x in xs]
        return Curve(knowledge, xs, ys)


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
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"cpu_s": cpu_s, "steps": json.loads(done.stdout).get("steps", 0)}
