"""A kr3_trials process: takes chunks of trials, gives their rows."""
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence

from kr3_experiments.errors import Kr3Error
from kr3_experiments.programs import find_program

Reply = Dict[str, Any]


class WorkerLost(Exception):
    """The process ended before its chunk did; another one may take the chunk."""


def trials_program() -> str:
    """Path of kr3_trials. @throws Kr3Error  it is not built"""
    return find_program("kr3_experiments", "kr3_trials")


class TrialWorker:
    """One process and the domain files that it was given. Not thread-safe."""

    def __init__(self, program: str, policies: Optional[Path] = None):
        """@param policies  folder where policies are kept; None: in the process only"""
        self._folder = tempfile.TemporaryDirectory(prefix="kr3_trials_")
        self._errors = (Path(self._folder.name) / "stderr").open("w+", encoding="utf-8")
        command = [program] + (["--policies", str(policies)] if policies else [])
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            start_new_session=True,  # Ctrl-C is for the sweep to handle
        )

    @property
    def process_id(self) -> int:
        """Of kr3_trials."""
        return self._process.pid

    def close(self) -> None:
        """End the process, whatever it does."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except BrokenPipeError:
                    pass
        self._errors.close()
        self._folder.cleanup()

    def run(
        self,
        digest: str,
        files: Mapping[str, str],
        job: Mapping[str, Any],
        trials: Sequence[Mapping[str, Any]],
    ) -> List[Reply]:
        """The rows of the trials and, last, what the chunk took.

        @param digest  of the configuration. @param files  of the domain, name -> text
        @throws WorkerLost  the process ended. @throws Kr3Error  the job is refused, with kr3_trials' words
        """
        request: Dict[str, Any] = {**job, "job": digest, "domain": self._domain(digest, files)}
        request["trials"] = list(trials)
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None and stdout is not None
        try:
            stdin.write(json.dumps(request) + "\n")
            stdin.flush()
        except (BrokenPipeError, ValueError) as error:
            raise WorkerLost(self._last_words()) from error
        replies: List[Reply] = []
        while True:
            line = stdout.readline()
            if not line.endswith("\n"):
                raise WorkerLost(self._last_words())
            reply = json.loads(line)
            if "error" in reply:
                raise Kr3Error(f"kr3_trials refuses the trials: {reply['error']}")
            replies.append(reply)
            if reply.get("done"):
                return replies

    def _domain(self, digest: str, files: Mapping[str, str]) -> str:
        folder = Path(self._folder.name) / digest
        if not folder.exists():
            folder.mkdir()
            for name, text in files.items():
                (folder / name).write_text(text, encoding="utf-8")
        return str(folder)

    def _last_words(self) -> str:
        self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().splitlines()[-5:]
        return f"kr3_trials ended with {self._process.returncode}: {' '.join(lines)}"
