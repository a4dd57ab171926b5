"""The rows of `bench robot` about drives, from what the trials report."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench"))
import bench_robot  # noqa: E402


def test_a_drive_that_was_rightly_refused_is_no_failure_and_did_not_arrive(tmp_path, monkeypatch):
    answer = {
        "runs": 10,
        "succeeded": 9,
        "rightly_refused": 2,
        "contacts": 1,
        "errors": {"scans": 5, "mean_m": 0.01, "max_m": 0.04, "normalised_squared_error": 2.0},
        "time_ratio_median": 1.1,
    }
    bench = bench_robot.Bench(tmp_path, quick=True, seed=1, work=tmp_path)
    monkeypatch.setattr(bench, "trials", lambda *_arguments: answer)
    bench.drives()
    rows = {row.name: row.value for row in bench.rows}
    assert rows["drives as they should be"] == 0.9
    assert rows["drives that arrived"] == 0.7
    assert rows["drives rightly refused"] == 2 * len(bench_robot.FLOORS)
    assert rows["contacts, half of the furniture moved"] == 1 * len(bench_robot.FLOORS)
