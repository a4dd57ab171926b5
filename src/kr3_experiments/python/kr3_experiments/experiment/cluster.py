"""Runs chunks on a Dask cluster. Every worker needs KR3's workspace sourced, nothing else of this machine."""
import threading
from typing import Any, Iterator, List, Mapping, Sequence, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.sweep import Chunk
from kr3_experiments.experiment.worker import Reply, TrialWorker, trials_program

_CONNECT_S = 15
_RETRIES = 5  # of a chunk whose worker was lost

_local = threading.local()  # a process of kr3_trials for each thread of a Dask worker


def run_chunk(
    digest: str,
    files: Mapping[str, str],
    job: Mapping[str, Any],
    trials: Sequence[Mapping[str, Any]],
) -> List[Reply]:
    """On a worker: the replies of a chunk. Its process, with its policies, is kept for the next one."""
    worker = getattr(_local, "worker", None)
    if worker is None:
        worker = _local.worker = TrialWorker(trials_program())
    try:
        return worker.run(digest, files, job, trials)
    except BaseException:
        worker.close()
        _local.worker = None
        raise


class DaskExecutor:
    """The workers of the scheduler at an address."""

    def __init__(self, address: str):
        """@throws Kr3Error  nobody answers there"""
        # Not at the top: only those who use a cluster wait for it to load.
        from distributed import Client  # pylint: disable=import-outside-toplevel

        try:
            self._client = Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise Kr3Error(f"no Dask scheduler answers at '{address}': {error}") from error

    def results(self, chunks: Sequence[Chunk]) -> Iterator[Tuple[Chunk, List[Reply]]]:
        """Chunks of lost workers are run again by others: rows depend on nothing but the job."""
        from distributed import as_completed  # pylint: disable=import-outside-toplevel

        futures = {
            self._client.submit(
                run_chunk,
                chunk.configuration.digest,
                dict(chunk.configuration.files),
                dict(chunk.configuration.point.job),
                chunk.trials(),
                pure=False,
                retries=_RETRIES,
            ): chunk
            for chunk in chunks
        }
        try:
            for future in as_completed(futures, loop=self._client.loop):
                yield futures[future], future.result()
        finally:
            self._client.cancel(list(futures))

    def close(self) -> None:
        """Leave the cluster."""
        self._client.close()
