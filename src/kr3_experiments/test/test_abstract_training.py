"""`./kr3 learn --world abstract`: what is learned in a world whose numbers are known."""
import shutil
from pathlib import Path
from typing import List

import pytest
import yaml

from kr3_experiments.cli import main
from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.abstract import attempts_in_abstract_world
from kr3_experiments.learning.counts import Attempt, Observed, count, read_attempts
from kr3_experiments.learning.models_file import action_name
from kr3_experiments.learning.session import conclude, load_lesson

OFFICE = repository_root() / "domains" / "office"
SENSOR = "{true_positive: 0.90, false_positive: 0.05, source: hand-written}"


def test_the_worlds_numbers_are_learned_and_not_the_robots(tmp_path: Path) -> None:
    folder = tmp_path / "office"
    shutil.copytree(OFFICE, folder)
    models = (folder / "models.yaml").read_text()
    assert SENSOR in models
    poor = SENSOR.replace("0.90", "0.70").replace("0.05", "0.20")
    (folder / "poor.yaml").write_text(models.replace(SENSOR, poor))
    lesson = load_lesson(folder)
    attempts = attempts_in_abstract_world(folder, 1500, 3, tmp_path / "a.jsonl", "poor.yaml")
    assert read_attempts(tmp_path / "a.jsonl") == attempts
    output = tmp_path / "models.yaml"
    conclude(lesson, lesson.laws({}), attempts, output, ["A test."], False)
    entries = {
        action_name(key, output)[0]: entry
        for key, entry in yaml.safe_load(output.read_text())["actions"].items()
    }
    sensor = entries["search"]["observations"]["loc"]
    assert sensor["source"] == "learned"
    # Four standard deviations of a share of 1500.
    assert sensor["true_positive"] == pytest.approx(0.70, abs=0.048)
    assert sensor["false_positive"] == pytest.approx(0.20, abs=0.042)
    assert entries["move"]["outcomes"]["probabilities"]["slipped"] == pytest.approx(0.05, abs=0.023)
    assert entries["move"]["cost"]["base_s"] == pytest.approx(1.0, abs=0.01)
    assert entries["move"]["cost"]["per_metre_s"] == pytest.approx(2.0, abs=0.001)


def test_a_shorter_training_phase_is_the_beginning_of_a_longer_one(tmp_path: Path) -> None:
    few, many = (
        attempts_in_abstract_world(OFFICE, trials, 5, tmp_path / "a.jsonl") for trials in (4, 9)
    )
    assert many[: len(few)] == few
    assert attempts_in_abstract_world(OFFICE, 4, 6, tmp_path / "a.jsonl") != few


def test_the_command_writes_a_models_file(tmp_path: Path) -> None:
    output = tmp_path / "learned.yaml"
    arguments = ["learn", "office", "--world", "abstract", "--trials", "30", "--seed", "2"]
    folder = ["--run-dir", str(tmp_path), "--output", str(output)]
    assert main([*arguments, *folder]) == 0
    text = output.read_text()
    assert "150 trials in the abstract world of models.yaml, seed 2" in text
    assert len(read_attempts(tmp_path / "attempts.jsonl")) == 150
    assert main([*arguments, *folder]) == 1  # these attempts are not lost
    assert len(read_attempts(tmp_path / "attempts.jsonl")) == 150


def test_a_domain_without_a_building_is_learned_in_the_abstract_world(tmp_path: Path) -> None:
    arguments = ["learn", "workbench", "--world", "abstract", "--trials", "2"]
    assert main([*arguments, "--run-dir", str(tmp_path)]) == 0
    assert "probe" in (tmp_path / "models_learned.yaml").read_text()


@pytest.mark.parametrize(
    "arguments, what",
    [
        (["--world", "abstract", "--world-models", "nowhere.yaml"], "nowhere.yaml"),
        (["--world", "abstract", "--attempts", "a.jsonl"], "--attempts and --world abstract"),
    ],
)
def test_bad_requests_are_refused_in_words(
    tmp_path: Path, arguments: List[str], what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["learn", "office", "--run-dir", str(tmp_path), *arguments]) == 1
    assert what in capsys.readouterr().err


def test_a_world_that_is_refused_is_told(tmp_path: Path) -> None:
    with pytest.raises(Kr3Error, match="no training in the abstract world.*no directory"):
        attempts_in_abstract_world(tmp_path / "nowhere", 1, 1, tmp_path / "a.jsonl")


def test_a_sensor_that_seems_worse_than_chance_keeps_its_numbers(tmp_path: Path) -> None:
    lesson = load_lesson(OFFICE)
    attempts = [
        Attempt("search", ("rob1", "c", "tb1"), True, "", (Observed("loc", truth, said),), 2.0)
        for truth, said in ((True, False), (True, False), (False, True), (False, False))
    ]
    output = tmp_path / "models.yaml"
    lines = conclude(lesson, lesson.laws({}), attempts, output, [], False)
    assert any("says no more than chance" in line for line in lines)
    search = next(
        entry
        for key, entry in yaml.safe_load(output.read_text())["actions"].items()
        if key.startswith("search")
    )
    assert search["observations"] == lesson.entries["search"]["observations"]
    assert count(attempts, {})["search"].sensors["loc"].total == 4
