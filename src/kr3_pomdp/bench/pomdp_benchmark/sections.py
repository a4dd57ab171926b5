"""The other measurements: values of policies, threads, loading, lookups, calls, deadlines."""

import contextlib
import json
import os
import pathlib
import shutil
import socket
import statistics
import subprocess
import time
from collections.abc import Iterator

from .figures import Figure
from .goals import (
    CALL_MS,
    DENSE_LOOKUP_US,
    LOAD_MB,
    LOAD_S,
    OVERSHOOT_MS,
    REFERENCES,
    SPARSE_LOOKUP_US,
    SPARSE_STATES,
    TWO_THREADS,
)
from .processes import BenchmarkError, run
from .session import Session

MEGABYTE = 1e6
LARGE_MODEL = "RockSample_11_11.pomdpx"
BENCH_FOLDER = pathlib.Path(__file__).resolve().parents[1]


def policies(session: Session, problems: list[str]) -> None:
    """Goal (d): what the last policy earns in simulation, between its bounds."""
    longest = max(session.times)
    print(f"\nPolicies after {longest:g} s CPU, {session.trials} simulated trials")
    for problem in problems:
        model = session.file(problem)
        policy = session.scratch / "policy"
        trace = session.programs.solve(model, ["--cpu-time", repr(longest)], policy=policy)
        mean, low, high = session.programs.simulate(model, policy, session.trials, session.seed)
        bounds = trace.last.bounds
        reference = REFERENCES.get(model.name)
        goal = reference.value if reference and longest >= 60.0 else None
        params = {"problem": model.name, "low": low, "high": high}
        session.add(Figure("simulated value", mean, "", goal, "higher", params))
        if high < bounds.lower or low > bounds.upper:
            # A law, not a goal: half a thousand intervals of 95 % would miss by chance, few far off.
            miss = max(bounds.lower - high, low - bounds.upper)
            session.add(Figure("value outside of the bounds by", miss, "", 0.0, "lower", params))


def threads(session: Session, problems: list[str]) -> None:
    """Goal (e): wall time of two threads to one thread's gap, as a part of one thread's."""
    longest = max(session.times)
    print("\nTwo threads: wall time to one thread's gap, as a part of one thread's")
    for problem in problems:
        model = session.file(problem)
        limit = ["--time", repr(longest)]
        one = session.programs.solve(model, limit)
        two = session.programs.solve(model, limit, threads=2)
        reached = two.time_to_gap(one.last.bounds.gap, "elapsed_s")
        first = one.time_to_gap(one.last.bounds.gap, "elapsed_s") or longest
        ratio = None if reached is None else reached / first
        params = {"problem": model.name, "cores": os.cpu_count()}
        session.add(Figure("two threads' time", ratio, "", TWO_THREADS, "lower", params))


def loading(session: Session) -> None:
    """Goal (f): CPU seconds and memory for reading a large factored model."""
    model = session.generated(LARGE_MODEL)
    print(f"\nReading {model.name}, {model.stat().st_size / 1000:.0f} kB")
    times, peaks = [], []
    for _ in range(session.runs):
        seconds, peak_bytes = _load(session, model)
        times.append(seconds)
        peaks.append(peak_bytes / MEGABYTE)
    params = {"problem": model.name}
    seconds = statistics.median(times)
    session.add(Figure("time to load", seconds, "s", LOAD_S, "lower", params, times))
    memory = statistics.median(peaks)
    session.add(Figure("memory to load", memory, "MB", LOAD_MB, "lower", params, peaks))


def _load(session: Session, model: pathlib.Path) -> tuple[float, int]:
    """CPU seconds and peak bytes until a model is read; solving is cut short."""
    trace = session.scratch / "load_trace"
    trace.write_text("")
    command = [session.programs.path("kr3_solve"), str(model), "--quiet", "--trace", str(trace)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        try:
            while "\n" not in trace.read_text():
                if process.poll() is not None:
                    raise BenchmarkError(f"{' '.join(command)}: {process.stderr.read().decode()}")
                time.sleep(0.005)
        finally:
            process.kill()
    first = json.loads(trace.read_text().splitlines()[0])
    return first["load_cpu_s"], first["load_peak_bytes"]


def deadlines(session: Session, problems: list[str]) -> None:
    """Goal (h): how much later than asked a run ends."""
    print("\nDeadlines: wall time beyond what was asked for, worst")
    for problem in problems:
        model = session.file(problem)
        late = []
        for asked in (0.05, 0.5):
            for _ in range(session.runs):
                trace = session.programs.solve(model, ["--time", repr(asked)])
                late.append(1000.0 * (trace.last.elapsed_s - asked))
        params = {"problem": model.name}
        session.add(Figure("overshoot", max(late), "ms", OVERSHOOT_MS, "lower", params, late))


def lookups(session: Session) -> None:
    """Goal (g), the library's part: policy_bench, a Google Benchmark program of the package."""
    print("\nAction of a policy of 2000 vectors over 1000 states")
    if not session.programs.has("policy_bench"):
        print("  policy_bench is not built (it needs libbenchmark-dev); left out")
        return
    output, _ = run([session.programs.path("policy_bench"), "--benchmark_format=json"])
    for benchmark in json.loads(output)["benchmarks"]:
        scale = {"ns": 1e-3, "us": 1.0, "ms": 1e3}[benchmark["time_unit"]]
        micros = benchmark["cpu_time"] * scale
        # Named by the number of states that the belief gives something to.
        dense = int(benchmark["name"].rsplit("/", 1)[-1]) > SPARSE_STATES
        goal = DENSE_LOOKUP_US if dense else SPARSE_LOOKUP_US
        params = {"case": benchmark["name"]}
        session.add(Figure("action lookup", micros, "us", goal, "lower", params))


def calls(session: Session) -> None:
    """Goal (g), over ROS: policy_node_latency.py times a node on a master of this benchmark's own."""
    print("\nService call for an action, while the node solves")
    script = BENCH_FOLDER / "policy_node_latency.py"
    if shutil.which("roscore") is None or "ROS_PACKAGE_PATH" not in os.environ:
        print("  no ROS in the environment; left out")
        return
    with _master(session.scratch) as environment:
        command = ["/usr/bin/python3", "-B", str(script), "--json"]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=300
        )
    if done.returncode != 0:
        raise BenchmarkError(f"policy_node_latency.py failed: {done.stderr.strip()[-500:]}")
    milliseconds = json.loads(done.stdout)["p50_ms"]
    params = {"node": "policy_node"}
    session.add(Figure("service call, median", milliseconds, "ms", CALL_MS, "lower", params))


@contextlib.contextmanager
def _master(scratch: pathlib.Path) -> Iterator[dict[str, str]]:
    """The environment of a ROS master on a free port, which ends with the block."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    environment = {**os.environ, **own, "ROS_HOME": str(scratch / "ros")}
    master = subprocess.Popen(
        ["roscore", "-p", str(port)],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        _wait_for_port(port, master)
        yield environment
    finally:
        master.terminate()
        master.wait()


def _wait_for_port(port: int, master: subprocess.Popen) -> None:
    end = time.monotonic() + 30.0
    while time.monotonic() < end and master.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    raise BenchmarkError("roscore did not start within 30 s")
