"""What experiments make of rows whose truth is known."""
import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any, Dict, List

import pytest

from kr3_experiments.cli import main
from kr3_experiments.domain import load_domain, repository_root
from kr3_experiments.errors import Kr3Error, StartError
from kr3_experiments.experiment import bench, command, robot
from kr3_experiments.experiment.accuracy import Accuracy
from kr3_experiments.experiment.default_bias import DefaultBias
from kr3_experiments.experiment.defaults import Defaults
from kr3_experiments.experiment.definition import Options, Table, plot, save_figures
from kr3_experiments.experiment.learning import Learning
from kr3_experiments.experiment.planning_time import PlanningTime
from kr3_experiments.experiment.points import TargetRule, configurations
from kr3_experiments.experiment.report import table_text, write_report
from kr3_experiments.experiment.robot import Robot
from kr3_experiments.variant import furnished_places
from kr3_experiments.experiment.rows import RowStore

QUICK = Options(quick=True, trials=8)


def outcome(seed: int, success: bool = True, **more: Any) -> Dict[str, Any]:
    row = {
        "config": "c",
        "commit": "abc",
        "seed": seed,
        "truth": "",
        "declared": True,
        "goal_true": success,
        "hl_actions": 4,
        "ll_actions": 9,
        "duration_s": 50.0 + seed,
        "backups": 0,
        "policies": "",
        "reason": "",
    }
    return {**row, **more}


def accuracy_rows(flat_succeeds: bool) -> List[Dict[str, Any]]:
    rows = []
    for method, seconds, success in (("pa", 0.0, True), ("pomdp1", 1.0, flat_succeeds)):
        label = {"method": method, "rooms": 2, "cells": 8, "noise": 1.0, "budget": 2_000}
        label["seconds"] = seconds
        rows += [outcome(seed, success, **label) for seed in range(8)]
    return rows


def test_accuracy_says_who_is_better_only_where_pairs_show_it() -> None:
    found = Accuracy().findings(accuracy_rows(flat_succeeds=False), QUICK)
    assert "as the paper says" in found.statements[0]
    assert found.tables[0].rows[1][5] == "8"  # false declarations of POMDP-1
    found = Accuracy().findings(accuracy_rows(flat_succeeds=True), QUICK)
    assert "no difference is shown" in found.statements[0]


def test_accuracy_says_why_where_the_paper_is_not_confirmed_and_how_long_missions_take() -> None:
    rows = accuracy_rows(flat_succeeds=True)
    for row in rows:
        row["duration_s"] *= 1.5 if row["method"] == "pa" else 1.0
    statements = Accuracy().findings(rows, QUICK).statements
    assert statements[0].endswith("PA's missions take 1.50 (1.50, 1.50) times as long.")
    assert statements[-1].startswith("Why POMDP-1 does not fall behind")
    confirmed = Accuracy().findings(accuracy_rows(flat_succeeds=False), QUICK).statements
    assert not any(text.startswith("Why") for text in confirmed)


def test_defaults_says_when_the_paper_is_contradicted() -> None:
    rows = []
    for rooms in (4, 6):
        for method, actions in (("pa", 9), ("pa_star", 6)):
            label = {"method": method, "rooms": rooms, "share": 0.8}
            rows += [outcome(seed, hl_actions=actions, **label) for seed in range(8)]
    found = Defaults().findings(rows, QUICK)
    assert all("against the paper, defaults cost actions" in text for text in found.statements)
    assert "1.50 (1.50, 1.50)" in found.statements[0]


def test_default_bias_does_not_take_missions_that_end_early_and_wrong_for_fast_ones() -> None:
    rows = [outcome(seed, method="pa", bias=0.0, target="exceptional") for seed in range(40)]
    for bias, factor, success in ((0.5, 0.8, True), (0.9, 0.5, False), (0.99, 2.0, True)):
        for seed in range(40):
            row = outcome(seed, success, method="pomdp2", bias=bias, target="exceptional")
            row["duration_s"] *= factor
            rows.append(row)
    time, success = DefaultBias().findings(rows, QUICK).statements
    assert "fastest at p = 0.5 and slowest at p = 0.99" in time
    assert "succeeds in 0.000 (0.000, 0.088) at p = 0.9" in success
    assert success.endswith("PA in 1.000 (0.912, 1.000).")


def test_planning_time_tells_floors_that_are_too_large_and_where_each_method_can_still_act() -> (
    None
):
    times = {
        (10, 10): {"all": 0.4, "relevant": 0.1, "relevant + 20 %": 0.2},
        (10, 1): {"PA": 0.03, "POMDP-1 online": 0.02, "POMDP-1 ahead": 3.0},
        (20, 1): {"PA": 0.04, "POMDP-1 online": 0.02, "POMDP-1 ahead": 0.01},
    }
    rows = [
        {
            **outcome(seed),
            **{"rooms": rooms, "objects": objects, "knowledge": name, "cpu_s": cpu_s},
            "steps": 0 if (rooms, name) == (20, "POMDP-1 ahead") else 1,
        }
        for (rooms, objects), each in times.items()
        for name, cpu_s in each.items()
        for seed in range(3)
    ]
    found = PlanningTime().findings(rows, QUICK)
    assert "4 times less" in found.statements[0]
    assert "POMDP-1 online after 0.020 s with 20 rooms" in found.statements[1]
    assert "POMDP-1 ahead after 3.000 s with 10 rooms" in found.statements[1]
    assert [row[-1] == "too large" for row in found.tables[1].rows] == [False, True]


@pytest.mark.parametrize("trials", [0, 1])
def test_sweeps_that_have_hardly_begun_state_nothing(trials: int) -> None:
    pa = {"method": "pa", "rooms": 4}
    bias = [outcome(seed, **pa, bias=0.0, target="normal") for seed in range(8)]
    bias += [outcome(seed, method="pomdp2", bias=0.5, target="normal") for seed in range(trials)]
    assert DefaultBias().findings(bias, QUICK).statements == []
    rows = [outcome(seed, **pa, share=0.8) for seed in range(8)]
    rows += [outcome(seed, method="pa_star", rooms=4, share=0.8) for seed in range(trials)]
    assert Defaults().findings(rows, QUICK).statements == []
    flat_only = [row for row in accuracy_rows(flat_succeeds=True) if row["method"] != "pa"]
    assert Accuracy().findings(flat_only, QUICK).statements == []


@pytest.mark.parametrize("experiment", [Accuracy(), Defaults(), DefaultBias(), Learning()])
def test_a_sweep_may_be_interrupted_anywhere(experiment: Any, tmp_path: Path) -> None:
    points = experiment.points(Options(trials=2))
    random = Random(1)
    for kept in (0.02, 0.1, 0.3, 0.6, 0.9):
        for trials in (0.5, 1.0):
            rows = [
                outcome(seed, random.random() < 0.9, **point.label)
                for point in points
                if random.random() < kept
                for seed in range(*point.seeds)
                if random.random() < trials
            ]
            if rows:
                found = experiment.findings(rows, Options(trials=2))
                if kept < 0.1 and trials < 1.0:  # drawing takes long
                    save_figures(found.figures, tmp_path)


def robot_rows() -> List[Dict[str, Any]]:
    rows = []
    for building in ("a", "b"):
        for method, factor in (("pa", 1.0), ("hierarchical", 1.5), ("oracle", 0.8)):
            for seed in range(6):
                row = outcome(seed, building=building, method=method, contacts=0, success=True)
                row["success"] = not (method == "hierarchical" and seed == 3)
                row["duration_s"] *= factor
                rows.append(row)
    return rows


def test_robot_pairs_missions_and_lists_every_failure() -> None:
    found = Robot().findings(robot_rows(), QUICK)
    assert "hierarchical POMDP-1 takes 1.50 (1.50, 1.50) times as long as PA over 12 pairs" in (
        found.statements[0]
    )
    assert "PA takes 1.25 (1.25, 1.25) times as long as oracle" in found.statements[1]
    assert found.statements[2].startswith("Why the ratio differs from the paper's 1.64")
    assert found.statements[3] == "2 of 36 missions failed."
    assert [row[2] for row in found.tables[1].rows] == ["3", "3"]


def test_robot_says_nothing_of_a_difference_that_the_interval_does_not_show() -> None:
    rows = robot_rows()
    for row in rows:
        if row["method"] == "hierarchical":
            row["duration_s"] *= 0.8 if row["seed"] % 2 else 1.4
    assert not any(text.startswith("Why") for text in Robot().findings(rows, QUICK).statements)


def test_robot_tells_pairs_with_the_object_in_its_usual_place_from_the_others() -> None:
    building = "floor_a"
    usual, other, *_ = load_domain(building, repository_root()).target.may_be_at
    rows = []
    for method, factor in (("pa", 3.0), ("oracle", 1.0)):
        for seed in range(6):
            row = outcome(seed, building=building, method=method, contacts=0)
            row["success"] = True
            row["truth"] = usual if seed < 4 else other
            row["duration_s"] *= factor if seed >= 4 else 1.0
            rows.append(row)
    text = Robot().findings(rows, QUICK).statements[0]
    assert "in its usual place 1.00 (1.00, 1.00) over 4 pairs" in text
    assert "in another 3.00 (3.00, 3.00) over 2 pairs" in text


def test_only_the_noise_of_the_goal_has_a_goal() -> None:
    rows = accuracy_rows(flat_succeeds=True)
    rows += [{**row, "noise": 2.0} for row in rows]
    goals = {f.params["noise"]: f.goal for f in bench._accuracy(rows) if f.name == "PA, success"}
    assert goals == {1.0: 0.95, 2.0: None}


def test_a_report_tells_the_commits_that_its_rows_were_made_at(tmp_path: Path) -> None:
    folder = tmp_path / "accuracy"
    point = configurations(Accuracy().points(QUICK)[:1], folder / "floors")[0]
    RowStore(folder, Accuracy().labels).add(
        outcome(seed, config=point.digest, commit=commit, **point.point.label)
        for seed, commit in ((1, "old"), (2, "old"), (3, "new"))
    )
    _, notes = command._results(Accuracy(), QUICK, folder, None)
    assert "1 at new, 2 at old" in notes[-1]


def test_bench_tells_goals_that_are_missed(capsys: pytest.CaptureFixture[str]) -> None:
    lines = [figure.line() for figure in bench._robot(robot_rows())]
    assert "met" in lines[1] and "NOT" not in lines[1]
    assert "NOT met" in lines[2]  # missions lost


def test_targets_obey_as_often_as_they_should_and_the_rest_is_spread() -> None:
    rule = TargetRule(rooms=5, usual="r2", share=0.8)
    rooms = [rule.room(seed) for seed in range(4000)]
    assert rooms.count("r2") / 4000 == pytest.approx(0.8, abs=0.02)
    for other in ("r1", "r3", "r4", "r5"):
        assert rooms.count(other) / 4000 == pytest.approx(0.05, abs=0.012)
    assert {TargetRule(rooms=3).room(seed) for seed in range(100)} == {"r1", "r2", "r3"}


def test_the_robot_starts_anywhere_whatever_is_drawn_for_its_target() -> None:
    fixed = TargetRule(rooms=4, usual="r2", share=0.8)
    drawn = TargetRule(rooms=4, usual="r2", share=0.8, start="loc(rob1)")
    trials = [drawn.trial(seed) for seed in range(4000)]
    for room in ("r1", "r2", "r3", "r4"):
        share = [trial["initially"] for trial in trials].count([f"loc(rob1) = {room}"]) / 4000
        assert share == pytest.approx(0.25, abs=0.03)
    assert [trial["truths"] for trial in trials] == [fixed.truths(seed) for seed in range(4000)]
    assert fixed.trial(7) == {"seed": 7, "truths": fixed.truths(7)}


def test_a_report_has_its_figures_and_tables(tmp_path: Path) -> None:
    found = Accuracy().findings(accuracy_rows(flat_succeeds=True), QUICK)
    lines = ["# T", *table_text(Table("N", ["a", "b"], [["1", "2"]]))]
    page = write_report(tmp_path, "T", lines, found)
    assert "<td>2</td>" in page.read_text()
    assert (tmp_path / "accuracy_noise_1.png").stat().st_size > 5000
    with pytest.raises(Kr3Error, match="cannot write the report"):
        write_report(page, "T", lines, found)


def test_an_interval_without_end_can_be_drawn(tmp_path: Path) -> None:
    found = Defaults().findings(
        [
            outcome(0, method=method, rooms=rooms, share=0.8)
            for method in ("pa", "pa_star")
            for rooms in (4, 6)
            for _ in range(1)
        ]
        + [
            outcome(1, method=method, rooms=rooms, share=0.8)
            for method in ("pa", "pa_star")
            for rooms in (4, 6)
        ],
        QUICK,
    )
    save_figures({**found.figures, "empty": plot([], "x", "y")}, tmp_path)
    assert (tmp_path / "defaults_hl_actions_by_rooms.png").exists()


@pytest.mark.parametrize(
    "arguments, what",
    [
        (["nonsense"], "unknown experiment 'nonsense'; there are accuracy"),
        (["accuracy", "--trials", "-1"], "--trials: found -1, expected a number from 0"),
        (["accuracy", "--jobs", "0"], "--jobs: found 0"),
        (["accuracy", "--report-only", "--out", "/nowhere"], "has no rows of accuracy"),
    ],
)
def test_bad_requests_are_refused_in_words(
    arguments: List[str], what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["experiment", *arguments]) == 1
    assert what in capsys.readouterr().err


def test_learned_numbers_make_floors_and_configurations_of_their_own(tmp_path: Path) -> None:
    points = command._points(Accuracy(), Options(quick=True, learned=True))[:1]
    plain = command._points(Accuracy(), QUICK)[:1]
    learned, hand = (configurations(each, tmp_path)[0] for each in (points, plain))
    assert "source: learned" in learned.files["models.yaml"]
    assert "source: learned" not in hand.files["models.yaml"]
    assert learned.digest != hand.digest


def test_rows_of_other_points_do_not_count(tmp_path: Path) -> None:
    store = RowStore(tmp_path / "accuracy", Accuracy().labels)
    label = {"method": "pa", "rooms": 2, "cells": 8, "noise": 1.0, "budget": 1, "seconds": 1.0}
    store.add([outcome(1, **label)])
    assert command.stored_rows(Accuracy(), QUICK, tmp_path / "accuracy") == []


def test_bench_writes_the_common_form(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "stored_rows", lambda *_: robot_rows())
    monkeypatch.setattr(bench, "_FIGURES", {"robot": bench._robot})
    assert main(["bench_experiments", "--json", str(tmp_path / "b.json")]) == 0
    content = json.loads((tmp_path / "b.json").read_text())
    assert content["bench"] == "experiments" and content["commit"]
    assert {"name", "value", "unit", "goal", "better", "params"} <= content["rows"][0].keys()


def test_the_goal_says_which_fluent_an_oracle_is_told() -> None:
    for folder in sorted((repository_root() / "domains").glob("*/building.yaml")):
        domain = load_domain(folder.parent.name, repository_root())
        assert domain.target.object in domain.target_fluent()


def test_missions_are_drawn_from_the_whole_building_the_same_for_every_method() -> None:
    setting, other = Robot().settings()[:2]
    draws = [setting.draw(seed) for seed in range(1000)]
    assert draws == [other.draw(seed) for seed in range(1000)]
    usual = setting.domain.target.may_be_at[0]
    truths = [draw.truth for draw in draws]
    assert truths.count(usual) / len(truths) == pytest.approx(0.8, abs=0.04)
    furnished = set(furnished_places(setting.domain))
    assert set(truths) == furnished
    assert {draw.start for draw in draws} == set(setting.domain.places)
    assert {draw.goal_place for draw in draws} == furnished - {usual}
    assert all(draw.goal_place != draw.truth for draw in draws)


@pytest.mark.parametrize("ends", [True, False])
def test_what_a_lost_mission_left_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ends: bool
) -> None:
    """The mission is played: what counts is what becomes of its results."""

    def mission(command: List[str], stdout: Any, **_: Any) -> Any:
        stdout.write("kr3: the robot stands\n")
        stdout.flush()
        if ends:
            summary = {"success": False, "declared": True, "reason": "elsewhere"}
            figures = {"high_level_actions": 4, "low_level_actions": 9, "robot_contacts": 0}
            folder = Path(command[command.index("--run-dir") + 1])
            summary.update(figures, mission_simulated_s=71.5)
            (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        return subprocess.CompletedProcess(command, 1)

    setting = Robot().settings()[0]
    monkeypatch.setattr(subprocess, "run", mission)
    row = robot._mission(setting, 7, "commit", tmp_path)
    assert not row["success"]
    assert row["reason"] == ("elsewhere" if ends else f"{robot._NO_MISSION}: kr3: the robot stands")
    assert row["duration_s"] == (71.5 if ends else robot._MISSION_LIMIT_S)
    kept = tmp_path / f"{setting.domain.name}_{setting.method}_7" / "output.txt"
    assert kept.read_text(encoding="utf-8") == "kr3: the robot stands\n"


@pytest.mark.parametrize("codes", [[3, 1], [3, 3, 3]])
def test_a_stack_that_does_not_come_up_is_started_again_and_no_method_blamed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, codes: List[int]
) -> None:
    """Only the number of starts is looked at; the mission is played."""

    def mission(command: List[str], **_: Any) -> Any:
        return subprocess.CompletedProcess(command, codes.pop(0))

    monkeypatch.setattr(subprocess, "run", mission)
    if codes[-1] == StartError.exit_code:
        with pytest.raises(StartError, match="did not come up in 3 tries"):
            robot._mission(Robot().settings()[0], 7, "commit", tmp_path)
    else:
        assert not robot._mission(Robot().settings()[0], 7, "commit", tmp_path)["success"]
    assert codes == []


def test_what_a_mission_depends_on_is_in_its_configuration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    floor = load_domain("floor_a", repository_root())
    copy = tmp_path / "floor"
    shutil.copytree(floor.folder, copy)
    before = robot._Setting(replace(floor, folder=copy), "pa").digest
    assert before == robot._Setting(floor, "pa").digest
    assert before != robot._Setting(floor, "hierarchical").digest
    texture = next(file for file in (copy / "textures").iterdir() if file.is_file())
    texture.write_bytes(texture.read_bytes() + b"x")
    assert before != robot._Setting(replace(floor, folder=copy), "pa").digest
