"""The benchmark's parts: reading traces and the peer's table, verdicts, errors. Programs are fakes."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

BENCH = Path(__file__).resolve().parents[1] / "bench"

FAKE_SOLVE = """#!/usr/bin/python3
import json, sys
arguments = sys.argv[1:]
if "--trace" not in arguments:
    sys.exit("no trace asked for")
points = [(0.01, 1.0, 3.0), (0.1, 1.5, 2.5), (0.2, 1.9, 2.0), (0.5, 1.95, 1.9505)]
with open(arguments[arguments.index("--trace") + 1], "w") as out:
    first = {"states": 2, "actions": 3, "observations": 2, "load_cpu_s": 0.1, "load_peak_bytes": 5}
    out.write(json.dumps(first) + "\\n")
    for cpu_s, lower, upper in points:
        out.write(json.dumps({"cpu_s": cpu_s, "elapsed_s": cpu_s, "lower": lower, "upper": upper,
                              "backups": 7, "vectors": 3, "peak_bytes": 1000000}) + "\\n")
if "--policy" in arguments:
    open(arguments[arguments.index("--policy") + 1], "w").close()
"""
FAKE_EVALUATE = """#!/usr/bin/python3
print("1.95100 (95 %: 1.85000, 2.05000), 100 trials of 3.0 steps on average")
"""
PEER_TABLE = """
Loading the model ...
  loading time : 0.01s
-------------------------------------------------------------------------------
 Time   |#Trial |#Backup |LBound    |UBound    |Precision  |#Alphas |#Beliefs
-------------------------------------------------------------------------------
 0       0       0        -20       -inf       inf         3        1
 0.04    2       51       -6.2981    63.1396    69.4377     7        16
 .5      3       103      1.0        3.5e+01    34          7        20
-------------------------------------------------------------------------------

SARSOP finishing ...
"""


@pytest.fixture(scope="module", autouse=True)
def bench_on_path():
    sys.path.insert(0, str(BENCH))
    yield
    sys.path.remove(str(BENCH))


def part(name):
    return importlib.import_module(f"pomdp_benchmark.{name}")


def executable(path, text):
    path.write_text(text)
    path.chmod(0o755)
    return path


@pytest.fixture
def programs(tmp_path):
    folder = tmp_path / "programs"
    folder.mkdir()
    executable(folder / "kr3_solve", FAKE_SOLVE)
    executable(folder / "kr3_evaluate", FAKE_EVALUATE)
    return folder


@pytest.fixture
def run_bench(programs):
    def run(*arguments):
        main = importlib.import_module("bench_pomdp").main
        return main(["--programs", str(programs), *arguments])

    return run


def test_the_peers_table_is_read_without_rows_that_bound_nothing():
    trace = part("peer").read_table(PEER_TABLE)
    assert [point.cpu_s for point in trace.points] == [0.04, 0.5]
    assert trace.last.bounds == part("goals").Bounds(1.0, 35.0)
    assert (trace.points[0].backups, trace.points[0].vectors) == (51, 7)


def test_a_peer_without_bounds_is_an_error():
    with pytest.raises(part("processes").BenchmarkError, match="printed no bounds: ERROR"):
        part("peer").read_table("ERROR: not a model")


def test_a_trace_is_read_off_at_times_and_gaps(programs):
    trace = part("processes").Programs(programs).solve(Path("m"), ["--cpu-time", "1"])
    assert trace.sizes == (2, 3, 2)
    assert trace.at(0.001) is None
    assert trace.at(0.15).bounds.gap == 1.0
    assert trace.at(100.0) is trace.last
    assert trace.time_to_gap(0.2) == 0.2
    assert trace.time_to_gap(1e-6) is None


def test_a_program_that_fails_is_named_with_what_it_said(tmp_path):
    processes = part("processes")
    program = executable(tmp_path / "broken", "#!/bin/sh\necho 'no memory' >&2\nexit 3\n")
    with pytest.raises(processes.BenchmarkError, match="broken ended with 3: no memory"):
        processes.run([str(program)])
    with pytest.raises(processes.BenchmarkError, match="cannot run .*absent: No such file"):
        processes.run([str(tmp_path / "absent")])
    slow = executable(tmp_path / "slow", "#!/bin/sh\nexec sleep 60\n")
    with pytest.raises(processes.BenchmarkError, match="slow took longer than 0.1 s"):
        processes.run([str(slow)], timeout_s=0.1)


@pytest.mark.parametrize(
    "value, goal, better, met",
    [
        (1.0, 2.0, "lower", True),
        (3.0, 2.0, "lower", False),
        (3.0, 2.0, "higher", True),
        (None, 2.0, "lower", False),
        (1.0, None, "lower", None),
    ],
)
def test_figures_are_judged(value, goal, better, met):
    assert part("figures").Figure("x", value, "s", goal, better).met is met


def test_means_are_geometric():
    assert part("figures").geometric_mean([1.0, 100.0]) == pytest.approx(10.0)
    with pytest.raises(ValueError, match="expected positive"):
        part("figures").geometric_mean([])


def test_the_greedy_rule_is_worth_what_was_published():
    floor = part("room_floor").greedy_floor(4, 10000, seed=3)
    assert abs(floor.mean - 59.16) < 4.0 * (floor.standard_error + 0.21)
    assert floor == part("room_floor").greedy_floor(4, 10000, seed=3)


def test_a_run_prints_bounds_and_writes_figures(run_bench, tmp_path, capsys):
    out = tmp_path / "figures.json"
    arguments = ["--problems", "Tiger,4x3.95", "--times", "0.1,0.5", "--runs", "2"]
    sections = "bounds,solved,policies"
    assert run_bench(*arguments, "--sections", sections, "--json", str(out)) == 0
    printed = capsys.readouterr().out
    assert "Tiger.pomdp                 0.1     1.5000     2.5000    1.0000" in printed
    report = json.loads(out.read_text())
    assert report["options"]["data"] == "generated"
    rows = {(row["name"], row["params"].get("problem")): row for row in report["rows"]}
    solved = rows["time to 1e-3", "4x3.95.pomdp"]
    assert (solved["value"], solved["goal"], solved["met"]) == (0.5, 0.25, False)
    assert rows["simulated value", "Tiger.pomdp"]["value"] == 1.951


def test_a_peer_runs_beside(run_bench, tmp_path, capsys):
    peer = executable(tmp_path / "pomdpsol", f"#!/bin/sh\ncat <<'TABLE'\n{PEER_TABLE}TABLE\n")
    arguments = ["--problems", "Tiger", "--times", "0.5", "--sections", "bounds"]
    assert run_bench(*arguments, "--peer", str(peer)) == 0
    assert "34.0000" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--problems", "Lion"], "unknown problem 'Lion', expected a model file or one of"),
        (["--sections", "luck"], "unknown section 'luck'"),
        (["--sections", "models"], "the section 'models' needs --data"),
        (["--times", "soon"], "found times 'soon'"),
        (["--times", "0"], "expected positive seconds"),
        (["--data", "/nowhere"], "found no folder /nowhere"),
        (["--peer", "/nowhere/pomdpsol"], "found no peer at /nowhere/pomdpsol"),
    ],
)
def test_what_is_missing_or_unknown_is_named(run_bench, arguments, message, capsys):
    assert run_bench(*arguments) == 1
    assert message in capsys.readouterr().err


def test_missing_programs_are_named(tmp_path, capsys):
    main = importlib.import_module("bench_pomdp").main
    assert main(["--programs", str(tmp_path)]) == 1
    assert "kr3_solve; build first" in capsys.readouterr().err


def test_published_files_are_preferred_and_others_generated(run_bench, tmp_path, capsys):
    data = tmp_path / "data"
    data.mkdir()
    (data / "Tiger.pomdp").write_text("not read by the fake\n")
    arguments = ["--data", str(data), "--times", "0.1", "--sections", "bounds"]
    assert run_bench("--problems", "Tiger,Hallway", *arguments) == 0
    assert "Hallway.pomdp" in capsys.readouterr().out


def test_only_what_exists_can_be_compared(run_bench, capsys):
    assert run_bench("--problems", "auvnavigation2d", "--sections", "bounds") == 1
    assert "unknown problem 'auvnavigation2d'" in capsys.readouterr().err


def test_a_section_that_fails_does_not_end_the_others(run_bench, programs, capsys):
    executable(programs / "kr3_evaluate", "#!/bin/sh\necho nothing\n")
    arguments = ["--problems", "Tiger", "--times", "0.1", "--runs", "1"]
    assert run_bench(*arguments, "--sections", "policies,deadlines") == 1
    printed = capsys.readouterr()
    assert "overshoot" in printed.out
    assert "policies: kr3_evaluate printed no interval: nothing" in printed.err


class ArrayModel:
    """Dense arrays with the interface of the Python module's models."""

    def __init__(self, transitions, observations, rewards):
        self.arrays = [np.array(array) for array in (transitions, observations)]
        self.rewards = np.array(rewards)

    def numStates(self):
        return self.arrays[0].shape[1]

    def numActions(self):
        return self.arrays[0].shape[0]

    def numObservations(self):
        return self.arrays[1].shape[2]

    def transitionEntries(self):
        return np.argwhere(self.arrays[0]), self.arrays[0][self.arrays[0] != 0.0]

    def observationEntries(self):
        return np.argwhere(self.arrays[1]), self.arrays[1][self.arrays[1] != 0.0]

    def rewardArray(self):
        return self.rewards


def test_models_are_compared_entry_by_entry():
    compare = part("published").compare
    first = ArrayModel([[[1.0, 0.0], [0.5, 0.5]]], [[[1.0], [1.0]]], [[0.0, 1.0]])
    second = ArrayModel([[[0.9, 0.1], [0.5, 0.5]]], [[[1.0], [1.0]]], [[0.0, 3.0]])
    assert compare(first, first, "same") == (0.0, 0)
    assert compare(first, second, "other") == (2.0, 2)
    third = ArrayModel([[[1.0]]], [[[1.0]]], [[0.0]])
    with pytest.raises(part("processes").BenchmarkError, match="larger: found sizes"):
        compare(first, third, "larger")
