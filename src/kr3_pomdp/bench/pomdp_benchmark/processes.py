"""Run the measured programs, one process each, and read how their bounds came nearer."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import time
from dataclasses import dataclass

from .goals import Bounds

# Traces have a point every fiftieth of their time and every 2 ms.
TRACE_STEP, TRACE_STEP_S = 1.025, 0.004
NUMBER = r"[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?|[-+]?(?:inf|nan)"


class BenchmarkError(Exception):
    """Something the user can mend: a missing program or file, an option out of range."""


@dataclass(frozen=True)
class Point:
    """Bounds after so many CPU seconds from the end of loading."""

    cpu_s: float
    elapsed_s: float
    bounds: Bounds
    backups: int
    vectors: int
    peak_bytes: int


@dataclass(frozen=True)
class Trace:
    """One run of a solver. Points are in the order of time; the last is the result."""

    points: tuple[Point, ...]
    load_cpu_s: float = 0.0
    load_peak_bytes: int = 0
    sizes: tuple[int, int, int] = (0, 0, 0)
    peak_bytes: int = 0

    def at(self, time_s: float, of: str = "cpu_s") -> Point | None:
        """The last point up to a time; None before the first."""
        limit = time_s * TRACE_STEP + TRACE_STEP_S
        before = [point for point in self.points if getattr(point, of) <= limit]
        return before[-1] if before else None

    def time_to_gap(self, gap: float, of: str = "cpu_s") -> float | None:
        """When the gap was at most `gap` for the first time; None when it never was."""
        return next((getattr(p, of) for p in self.points if p.bounds.gap <= gap), None)

    @property
    def last(self) -> Point:
        return self.points[-1]


def run(command: list[str], timeout_s: float = 3600.0) -> tuple[str, int]:
    """Standard output and greatest memory in bytes of a process.

    @raises BenchmarkError  it cannot be run, failed, or took too long
    """
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
        try:
            process = subprocess.Popen(command, stdout=out, stderr=errors)
        except OSError as error:
            raise BenchmarkError(f"cannot run {command[0]}: {error.strerror}") from error
        peak_bytes = _watch(process, timeout_s)
        out.seek(0)
        errors.seek(0)
        if process.returncode != 0:
            said = errors.read().strip() or out.read().strip()[-500:]
            raise BenchmarkError(f"{' '.join(command)} ended with {process.returncode}: {said}")
        return out.read(), peak_bytes


def _watch(process: subprocess.Popen, timeout_s: float) -> int:
    """Waits for a process; the greatest memory in bytes that it was seen to have.

    What the system tells at its end (ru_maxrss) would include this program's own memory, from which
    it was forked.
    """
    end = time.monotonic() + timeout_s
    peak_bytes = 0
    try:
        while process.poll() is None:
            peak_bytes = max(peak_bytes, _resident_peak(process.pid))
            if time.monotonic() > end:
                raise BenchmarkError(f"{process.args[0]} took longer than {timeout_s:g} s")
            time.sleep(0.01)
    finally:
        process.kill()
        process.wait()
    return peak_bytes


def _resident_peak(pid: int) -> int:
    """VmHWM in bytes; 0 for a process that has ended."""
    try:
        status = pathlib.Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0
    found = re.search(r"VmHWM:\s*([0-9]+) kB", status)
    return int(found[1]) * 1024 if found else 0


@dataclass(frozen=True)
class Programs:
    """The built programs of this package.

    @raises BenchmarkError  the folder or one that every measurement needs is missing
    """

    folder: pathlib.Path

    def __post_init__(self) -> None:
        for name in ("kr3_solve", "kr3_evaluate"):
            if not self.has(name):
                raise BenchmarkError(f"found no program {self.folder / name}; build first")

    def has(self, name: str) -> bool:
        return os.access(self.folder / name, os.X_OK)

    def path(self, name: str) -> str:
        return str(self.folder / name)

    def solve(
        self,
        model: pathlib.Path,
        limit: list[str],
        precision: float = 0.0,
        threads: int = 1,
        policy: pathlib.Path | None = None,
    ) -> Trace:
        """Bounds over time. `limit`: the options that end the run."""
        with tempfile.TemporaryDirectory() as folder:
            trace = pathlib.Path(folder) / "trace"
            command = [self.path("kr3_solve"), str(model), "--quiet", "--trace", str(trace)]
            command += ["--precision", repr(precision), *limit]
            if "--time" not in limit:
                command += ["--time", "0"]
            if threads != 1:
                command += ["--threads", str(threads)]
            if policy is not None:
                command += ["--policy", str(policy)]
            _, peak_bytes = run(command)
            return read_trace(trace.read_text(), peak_bytes)

    def simulate(
        self, model: pathlib.Path, policy: pathlib.Path, trials: int, seed: int
    ) -> tuple[float, float, float]:
        """Mean return of a policy and the ends of its 95 % interval."""
        command = [self.path("kr3_evaluate"), str(model), str(policy)]
        output, _ = run([*command, "--trials", str(trials), "--seed", str(seed)])
        found = re.search(rf"({NUMBER}) \(95 %: ({NUMBER}), ({NUMBER})\)", output)
        if not found:
            raise BenchmarkError(f"kr3_evaluate printed no interval: {output.strip()[:200]}")
        return float(found[1]), float(found[2]), float(found[3])


def read_trace(text: str, peak_bytes: int) -> Trace:
    """What kr3_solve --trace wrote."""
    first, *lines = (json.loads(line) for line in text.splitlines())
    points = tuple(
        Point(
            line["cpu_s"],
            line["elapsed_s"],
            Bounds(line["lower"], line["upper"]),
            line["backups"],
            line["vectors"],
            line["peak_bytes"],
        )
        for line in lines
    )
    sizes = (first["states"], first["actions"], first["observations"])
    return Trace(points, first["load_cpu_s"], first["load_peak_bytes"], sizes, peak_bytes)
