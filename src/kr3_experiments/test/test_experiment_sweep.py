"""Sweeps with the real kr3_trials: rows do not depend on how they were computed."""
import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import Iterator, List, Sequence, Tuple

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.points import (
    Configuration,
    Floor,
    Point,
    TargetRule,
    configurations,
)
from kr3_experiments.experiment.rows import Row, RowStore
from kr3_experiments.experiment.sweep import Chunk, LocalExecutor, missing_chunks, run_sweep
from kr3_experiments.experiment.worker import Reply, TrialWorker, WorkerLost, trials_program

LABELS = {"method": str}
TRIALS = 6


def points(**changes: object) -> List[Point]:
    return [
        Point(
            label={"method": method},
            floor=Floor(rooms=3, cells=2, defaults=1),
            target=TargetRule(rooms=3),
            job={"method": method, **changes},
            seeds=(1, 1 + TRIALS),
        )
        for method in ("pa", "pa_star")
    ]


@pytest.fixture(name="world")
def _world(tmp_path: Path) -> List[Configuration]:
    return configurations(points(), tmp_path / "floors")


def sweep(world: Sequence[Configuration], folder: Path, jobs: int, size: int = 2) -> List[Row]:
    store = RowStore(folder, LABELS)
    run_sweep(world, store, LocalExecutor(trials_program(), jobs, None), size)
    return store.of([configuration.digest for configuration in world])


def test_rows_are_the_same_however_they_are_computed(
    world: List[Configuration], tmp_path: Path
) -> None:
    one = sweep(world, tmp_path / "one", jobs=1)
    two = sweep(world, tmp_path / "two", jobs=2, size=1)
    assert len(one) == 2 * TRIALS
    assert one == two
    assert all(row["declared"] for row in one)
    assert len({row["truth"] for row in one}) > 1
    assert all(row["policies"] for row in one if row["ll_actions"] > 0)


def test_methods_meet_the_same_worlds(world: List[Configuration], tmp_path: Path) -> None:
    rows = sweep(world, tmp_path / "out", jobs=2)
    first, second = (
        [(row["seed"], row["truth"]) for row in rows if row["method"] == method]
        for method in ("pa", "pa_star")
    )
    assert first == second


class Interrupted(Exception):
    """Stands for Ctrl-C."""


class StoppedHalfway:
    """Ends a sweep after some chunks."""

    def __init__(self, executor: LocalExecutor, chunks: int):
        self._executor = executor
        self._chunks = chunks

    def results(self, chunks: Sequence[Chunk]) -> Iterator[Tuple[Chunk, List[Reply]]]:
        for i, item in enumerate(self._executor.results(chunks)):
            if i == self._chunks:
                raise Interrupted
            yield item


def test_an_interrupted_sweep_resumes_without_losing_or_repeating(
    world: List[Configuration], tmp_path: Path
) -> None:
    whole = sweep(world, tmp_path / "whole", jobs=1)
    folder = tmp_path / "halves"
    store = RowStore(folder, LABELS)
    executor = LocalExecutor(trials_program(), 2, None)
    with pytest.raises(Interrupted):
        run_sweep(world, store, StoppedHalfway(executor, 2), 2)
    done = {(row["config"], row["seed"]) for row in store.rows}
    assert len(done) == 4
    left = {
        (chunk.configuration.digest, seed)
        for chunk in missing_chunks(world, RowStore(folder, LABELS), 2)
        for seed in chunk.seeds
    }
    assert not done & left and len(done | left) == 2 * TRIALS
    assert sweep(world, folder, jobs=2) == whole


def test_a_lost_process_is_replaced(world: List[Configuration], tmp_path: Path) -> None:
    class Fragile(LocalExecutor):
        """Loses its first process."""

        lost = False

        def _run(self, chunk, number, workers, lock, stop):  # type: ignore[no-untyped-def]
            if not Fragile.lost:
                Fragile.lost = True
                workers[number] = TrialWorker(trials_program())
                os.kill(workers[number].process_id, signal.SIGKILL)
            return super()._run(chunk, number, workers, lock, stop)

    store = RowStore(tmp_path / "fragile", LABELS)
    run_sweep(world, store, Fragile(trials_program(), 1, None), 3)
    assert Fragile.lost
    assert store.of([c.digest for c in world]) == sweep(world, tmp_path / "whole", jobs=1)


def test_a_lost_process_is_told(world: List[Configuration]) -> None:
    worker = TrialWorker(trials_program())
    os.kill(worker.process_id, signal.SIGKILL)
    with pytest.raises(WorkerLost, match="ended with -9"):
        worker.run(world[0].digest, world[0].files, {}, [{"seed": 1}])
    worker.close()


def test_a_refused_job_ends_the_sweep_in_words(tmp_path: Path) -> None:
    world = configurations(points(bias=3.0), tmp_path / "floors")
    with pytest.raises(Kr3Error, match="'bias': found 3.0"):
        sweep(world, tmp_path / "out", jobs=1)


def with_models(floor: List[Configuration], world: str, robot: str) -> List[Configuration]:
    """The first point, with models of world and robot."""
    point = floor[0].point
    files = {"world.yaml": world, "robot.yaml": robot}
    job = {**point.job, "models": "robot.yaml", "world_models": "world.yaml"}
    changed = replace(point, job=job, files=files, seeds=(1, 31))
    return [Configuration(changed, {**floor[0].files, **files})]


def test_a_world_may_differ_from_what_the_robot_believes(
    world: List[Configuration], tmp_path: Path
) -> None:
    models = world[0].files["models.yaml"]
    believed = "true_positive: 0.90, false_positive: 0.05"
    assert believed in models
    poor = models.replace(believed, "true_positive: 0.80, false_positive: 0.40")
    grasp = "succeeded: 0.9, failed: 0.1"
    assert grasp in models
    worse = poor.replace(grasp, "succeeded: 0.5, failed: 0.5")
    results = ("declared", "goal_true", "hl_actions", "ll_actions", "duration_s", "policies")

    def outcomes(configurations: List[Configuration], folder: str) -> List[List[object]]:
        rows = sweep(configurations, tmp_path / folder, jobs=1, size=30)
        return [[row[column] for column in results] for row in rows]

    equal = outcomes(with_models(world, models, models), "equal")
    assert equal[:TRIALS] == outcomes(world[:1], "one")
    knowing = outcomes(with_models(world, worse, worse), "knowing")
    trusting = outcomes(with_models(world, worse, models), "trusting")
    assert knowing != trusting != equal
    digests = {
        with_models(world, first, second)[0].digest
        for first in (models, poor)
        for second in (models, poor)
    }
    assert len(digests) == 4


def test_the_configuration_names_what_rows_depend_on(tmp_path: Path) -> None:
    base, other = (
        configurations(points(**change), tmp_path) for change in ({}, {"precision": 1.0})
    )
    assert base[0].digest != base[1].digest
    assert base[0].digest != other[0].digest
    assert base[0].digest == configurations(points(), tmp_path)[0].digest


def test_a_detector_that_misses_much_costs_looks_and_not_missions(tmp_path: Path) -> None:
    """One look into each cell of a room refutes nothing there: the robot has to try the other rooms all the same."""
    floor = Floor(rooms=9, cells=4, defaults=0, noise=2.0, models="models_learned.yaml")
    point = Point(
        label={"method": "pa"},
        floor=floor,
        target=TargetRule(rooms=9),
        job={"method": "pa", "max_hl_actions": 76, "max_backups": 1000},
        seeds=(1, 31),
    )
    rows = sweep(configurations([point], tmp_path / "floors"), tmp_path / "rows", jobs=2, size=15)
    found = sum(row["declared"] and row["goal_true"] for row in rows)
    assert found >= 27
