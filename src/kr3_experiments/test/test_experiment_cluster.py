"""The same rows from a Dask cluster on the loopback interface, also when a worker is ended halfway."""
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Iterator, List, Sequence, Tuple

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.cluster import DaskExecutor
from kr3_experiments.experiment.points import Floor, Point, TargetRule, configurations
from kr3_experiments.experiment.rows import RowStore
from kr3_experiments.experiment.sweep import Chunk, LocalExecutor, run_sweep
from kr3_experiments.experiment.worker import Reply, trials_program

LABELS = {"method": str}
START_S = 60.0


class Cluster:
    """A scheduler and workers, each a process of this test."""

    def __init__(self, folder: Path):
        self._folder = folder
        file = folder / "scheduler.json"
        self._processes: List[subprocess.Popen] = []  # type: ignore[type-arg]
        common = ["--scheduler-file", str(file)]
        self._start(
            "dask_scheduler", ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", *common]
        )
        deadline = time.monotonic() + START_S
        while not file.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        self.workers = [
            self._start(
                "dask_worker",
                ["--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--no-nanny", *common],
            )
            for _ in range(2)
        ]
        self.address = json.loads(file.read_text())["address"]

    def _start(self, module: str, options: List[str]) -> "subprocess.Popen[bytes]":
        number = len(self._processes)
        log = (self._folder / f"{number}.log").open("w")
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{module}", *options],
            stdout=log,
            stderr=log,
            cwd=self._folder,
        )
        self._processes.append(process)
        return process

    def close(self) -> None:
        for process in reversed(self._processes):
            process.kill()
            process.wait()


@pytest.fixture(name="cluster")
def _cluster(tmp_path: Path) -> Iterator[Cluster]:
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.close()


class LosesAWorker:
    """Ends one worker of the cluster after the first chunk."""

    def __init__(self, executor: DaskExecutor, cluster: Cluster):
        self._executor = executor
        self._cluster = cluster

    def results(self, chunks: Sequence[Chunk]) -> Iterator[Tuple[Chunk, List[Reply]]]:
        for i, item in enumerate(self._executor.results(chunks)):
            if i == 0:
                self._cluster.workers[0].kill()
            yield item


def test_rows_from_a_cluster_that_loses_a_worker_are_bit_identical(
    cluster: Cluster, tmp_path: Path
) -> None:
    point = Point(
        label={"method": "pa"},
        floor=Floor(rooms=3, cells=2, defaults=1),
        target=TargetRule(rooms=3),
        job={"method": "pa"},
        seeds=(1, 13),
    )
    world = configurations([point], tmp_path / "floors")
    here = RowStore(tmp_path / "here", LABELS)
    run_sweep(world, here, LocalExecutor(trials_program(), 1, None), 4)
    there = RowStore(tmp_path / "there", LABELS)
    executor = DaskExecutor(cluster.address)
    try:
        run_sweep(world, there, LosesAWorker(executor, cluster), 1)
    finally:
        executor.close()
    digests = [world[0].digest]
    assert cluster.workers[0].poll() is not None
    assert len(there.rows) == 12
    assert there.of(digests) == here.of(digests)


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kr3_experiments.experiment.cluster._CONNECT_S", 1)
    with pytest.raises(Kr3Error, match="no Dask scheduler answers at 'tcp://127.0.0.1:1'"):
        DaskExecutor("tcp://127.0.0.1:1")
