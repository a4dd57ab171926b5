"""Runs the trials that a sweep lacks, on this machine's cores or on a Dask cluster, and keeps their rows."""
import queue
import sys
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Protocol, Sequence, Tuple

from kr3_common.bench_report import commit as commit_of
from tqdm import tqdm

from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.points import Configuration
from kr3_experiments.experiment.rows import Row, RowStore
from kr3_experiments.experiment.worker import Reply, TrialWorker, WorkerLost

_ATTEMPTS = 3  # of a chunk whose worker was lost


@dataclass(frozen=True)
class Chunk:
    """Trials of one configuration, run one after the other in one process."""

    configuration: Configuration
    seeds: Tuple[int, ...]

    def trials(self) -> List[Dict[str, Any]]:
        """As kr3_trials takes them."""
        rule = self.configuration.point.target
        return [rule.trial(seed) for seed in self.seeds]


class Executor(Protocol):
    """Where chunks are run."""

    def results(self, chunks: Sequence[Chunk]) -> Iterator[Tuple[Chunk, List[Reply]]]:
        """Each chunk with its replies, in any order."""


def missing_chunks(
    configurations: Sequence[Configuration], store: RowStore, size: int
) -> List[Chunk]:
    """What is not in the store, at most `size` trials a chunk."""
    chunks = []
    for configuration in configurations:
        seeds = [
            seed
            for seed in configuration.point.all_seeds()
            if not store.has(configuration.digest, seed)
        ]
        chunks += [
            Chunk(configuration, tuple(seeds[i : i + size])) for i in range(0, len(seeds), size)
        ]
    return chunks


def commit() -> str:
    """Of the repository, with "+" when files differ from it; "unknown" outside of one."""
    return commit_of(repository_root())


def rows_of(chunk: Chunk, replies: Sequence[Reply], head: str) -> List[Row]:
    """The rows of a chunk's replies."""
    rule = chunk.configuration.point.target
    rows = []
    for reply in replies[:-1]:
        row: Row = dict(chunk.configuration.point.label)
        row.update(
            config=chunk.configuration.digest,
            commit=head,
            seed=reply["seed"],
            truth="; ".join(rule.truths(reply["seed"]) + rule.initially(reply["seed"])),
            declared=reply["declared"],
            goal_true=reply["goal_true"],
            hl_actions=reply["hl_actions"],
            ll_actions=reply["ll_actions"],
            duration_s=reply["duration_s"],
            backups=reply["backups"],
            policies=" ".join(policy[:12] for policy in reply["policies"]),
            reason=reply["reason"],
        )
        rows.append(row)
    return rows


@dataclass
class Work:
    """What the trials of one configuration took in this run. It differs between machines: no part of the rows."""

    trials: int = 0
    cpu_s: float = 0.0
    policy_hits: int = 0
    policy_misses: int = 0

    def add(self, replies: Sequence[Reply]) -> None:
        """Count a chunk."""
        end = replies[-1]
        self.trials += len(replies) - 1
        self.cpu_s += end["cpu_s"]
        self.policy_hits += end["policy_hits"]
        self.policy_misses += end["policy_misses"]


def run_sweep(
    configurations: Sequence[Configuration],
    store: RowStore,
    executor: Executor,
    chunk_size: int = 20,
) -> Dict[str, Work]:
    """Run what is missing, and show how far it is.

    Rows are stored chunk by chunk: an interrupted sweep goes on where it was.
    @return what this run took, by configuration. @throws Kr3Error  a job is refused, or a chunk loses every worker
    """
    chunks = missing_chunks(configurations, store, chunk_size)
    wanted = sum(len(configuration.point.all_seeds()) for configuration in configurations)
    todo = sum(len(chunk.seeds) for chunk in chunks)
    head = commit()
    work: Dict[str, Work] = {}
    quiet = not sys.stderr.isatty()
    with tqdm(
        total=wanted,
        initial=wanted - todo,
        unit="trial",
        mininterval=30.0 if quiet else 0.2,
        ascii=quiet,
        ncols=100 if quiet else None,
    ) as bar:
        for chunk, replies in executor.results(chunks):
            store.add(rows_of(chunk, replies, head))
            work.setdefault(chunk.configuration.digest, Work()).add(replies)
            bar.update(len(chunk.seeds))
    return work


class LocalExecutor:
    """`jobs` processes on this machine. Chunks of the same configuration tend to meet the same process."""

    def __init__(self, program: str, jobs: int, policies: Optional[Path]):
        self._program = program
        self._jobs = jobs
        self._policies = policies

    def results(self, chunks: Sequence[Chunk]) -> Iterator[Tuple[Chunk, List[Reply]]]:
        """@throws Kr3Error  the first failure; the other processes are ended then, and when the caller stops"""
        waiting: "queue.SimpleQueue[Chunk]" = queue.SimpleQueue()
        for chunk in chunks:
            waiting.put(chunk)
        done: "queue.SimpleQueue[Any]" = queue.SimpleQueue()
        workers: Dict[int, TrialWorker] = {}
        lock = threading.Lock()
        stop = threading.Event()

        def serve(number: int) -> None:
            while not stop.is_set():
                try:
                    chunk = waiting.get_nowait()
                except queue.Empty:
                    return
                try:
                    done.put((chunk, self._run(chunk, number, workers, lock, stop)))
                except Exception as error:  # handed to the thread that waits
                    done.put(error)
                    return

        threads = [
            threading.Thread(target=serve, args=(number,), daemon=True)
            for number in range(min(self._jobs, len(chunks)))
        ]
        for thread in threads:
            thread.start()
        try:
            for _ in chunks:
                item = done.get()
                if isinstance(item, Exception):
                    raise item
                yield item
        finally:
            stop.set()
            with lock:
                for worker in workers.values():
                    worker.close()

    def _run(
        self,
        chunk: Chunk,
        number: int,
        workers: Dict[int, TrialWorker],
        lock: threading.Lock,
        stop: threading.Event,
    ) -> List[Reply]:
        configuration = chunk.configuration
        for attempt in range(1, _ATTEMPTS + 1):
            with lock:
                if stop.is_set():
                    raise Kr3Error("the sweep was stopped")
                worker = workers.get(number)
                if worker is None:
                    worker = workers[number] = TrialWorker(self._program, self._policies)
            try:
                return worker.run(
                    configuration.digest,
                    configuration.files,
                    configuration.point.job,
                    chunk.trials(),
                )
            except WorkerLost as error:
                with lock:
                    workers.pop(number).close()
                if attempt == _ATTEMPTS:
                    seeds = f"seeds {chunk.seeds[0]} to {chunk.seeds[-1]}"
                    label = dict(configuration.point.label)
                    raise Kr3Error(f"{error}; {_ATTEMPTS} times at {label}, {seeds}") from error
        raise AssertionError("unreachable")
