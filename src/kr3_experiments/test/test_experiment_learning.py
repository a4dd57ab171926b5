"""The experiment about learned models: distances with known values, training phases, findings of known rows."""
import math
from pathlib import Path
from typing import Any, Dict, List

import pytest
import yaml

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment import bench, learning
from kr3_experiments.experiment.definition import Options
from kr3_experiments.experiment.learning import Groups, Learning
from kr3_experiments.experiment.points import configurations
from kr3_experiments.experiment.rows import RowStore
from kr3_experiments.experiment.sweep import LocalExecutor, run_sweep
from kr3_experiments.experiment.worker import trials_program
from kr3_experiments.learning.counts import Counts, Sensor
from kr3_experiments.learning.model_error import kl_divergence, model_error, total_variation

QUICK = Options(quick=True, trials=3)

MODELS = """
actions:
  move(R, C):
    outcomes: {probabilities: {reached: 0.9, slipped: 0.1}}
    observations: {loc: exact}
  search(R, C, O):
    observations: {loc: {true_positive: 0.8, false_positive: 0.1}}
"""


def test_distances_have_their_known_values() -> None:
    half, certain = {"a": 0.5, "b": 0.5}, {"a": 1.0}
    assert total_variation(half, certain) == pytest.approx(0.5)
    assert total_variation({"a": 1.0}, {"b": 1.0}) == pytest.approx(1.0)
    assert kl_divergence(certain, half) == pytest.approx(math.log(2))
    assert kl_divergence(half, certain) == math.inf
    assert total_variation(half, half) == kl_divergence(half, half) == 0.0


def test_a_model_is_compared_distribution_by_distribution() -> None:
    true = yaml.safe_load(MODELS)
    assert model_error(true, true, {}).divergence == 0.0
    learned = yaml.safe_load(
        MODELS.replace("0.9, slipped: 0.1", "0.7, slipped: 0.3")
        .replace("true_positive: 0.8", "true_positive: 0.9")
        .replace("false_positive: 0.1", "false_positive: 0.4")
    )
    error = model_error(true, learned, {})
    assert error.transition_error == pytest.approx(0.2)
    assert error.observation_error == pytest.approx((0.1 + 0.3) / 2)
    assert error.divergence > 0.0
    with pytest.raises(Kr3Error, match="different outcomes or observations"):
        model_error(true, yaml.safe_load(MODELS.replace(", false_positive: 0.1", "")), {})
    with pytest.raises(Kr3Error, match="no action 'search'"):
        model_error(true, yaml.safe_load(MODELS.replace("search", "look")), {})


def test_intervals_that_hold_the_truth_are_counted() -> None:
    true = yaml.safe_load(MODELS)
    counts = {
        "move": Counts(outcomes={"reached": 90, "slipped": 10}),
        "search": Counts(
            sensors={"loc": Sensor(False, true_positive=20, false_negative=80, true_negative=90)}
        ),
    }
    counts["search"].sensors["loc"].false_positive = 10
    error = model_error(true, true, counts)
    assert (error.covered, error.intervals) == (2, 3)  # 0.2 is far from 0.8


def test_more_samples_bring_the_models_nearer_to_the_truth() -> None:
    points = Learning().points(QUICK)
    labels = [point.label for point in points]
    assert [label["models"] for label in labels[:2]] == ["true", "hand-written"]
    assert labels[0]["error_o"] == 0.0 and labels[1]["error_o"] > 0.05
    few, many = (
        [label for label in labels if label["models"] == "learned" and label["samples"] == n]
        for n in (3, 30)
    )
    assert len(few) == len(many) > 1
    for column in ("error_t", "error_o", "divergence"):
        assert sum(label[column] for label in many) < sum(label[column] for label in few)
    texts = {point.files["robot.yaml"] for point in points}
    assert len(texts) == len(points)  # each training phase learns numbers of its own
    assert all(point.job["world_models"] == "models.yaml" for point in points)
    again = Learning().points(QUICK)
    assert [point.files for point in again] == [point.files for point in points]


def test_missions_are_run_with_the_learned_models_in_the_true_world(tmp_path: Path) -> None:
    points = Learning().points(QUICK)[:3]
    world = configurations(points, tmp_path / "floors")
    assert len({configuration.digest for configuration in world}) == len(points)
    assert len({configuration.files["models.yaml"] for configuration in world}) == 1
    assert world[0].files["robot.yaml"] == world[0].files["models.yaml"]
    store = RowStore(tmp_path, Learning().labels)
    run_sweep(world, store, LocalExecutor(trials_program(), 1, None))
    rows = store.of([configuration.digest for configuration in world])
    assert len(rows) == 3 * QUICK.trials
    assert {row["truth"] for row in rows[:3]} == {row["truth"] for row in rows[-3:]}
    assert RowStore(tmp_path, Learning().labels).rows == store.rows  # labels are read back exactly


def test_training_phases_that_count_the_same_are_different_trials() -> None:
    texts = [learning._trained(3, (2,), training)[0][1] for training in range(12)]
    assert len({text.split("\n", 1)[1] for text in texts}) < len(texts)  # two samples of each
    assert len(set(texts)) == len(texts)


def row(seed: int, models: str, samples: int, training: int, actions: int) -> Dict[str, Any]:
    return {
        **{"config": f"{models}{samples}{training}", "commit": "abc", "seed": seed, "truth": ""},
        **{"models": models, "samples": samples, "training": training, "divergence": 0.1},
        **{"error_t": 0.1 + training / 100, "error_o": 1.0 / (samples + 1)},
        **{"intervals": 4, "covered": 4 if training == 1 else 3, "declared": True},
        **{"goal_true": not (samples == 3 and seed == 0), "hl_actions": 4},
        **{"ll_actions": actions, "duration_s": 10.0 * actions, "backups": 0, "policies": ""},
        "reason": "",
    }


def test_losses_are_paired_with_the_true_models_and_spread_over_trainings() -> None:
    rows: List[Dict[str, Any]] = []
    for seed in range(6):
        rows += [row(seed, "true", 0, 0, 10 + seed), row(seed, "hand-written", 0, 0, 10 + seed)]
        for training in (1, 2, 3):
            rows.append(row(seed, "learned", 3, training, 20 + seed + training))
            rows.append(row(seed, "learned", 100, training, 10 + seed))
    found = Learning().findings(rows, QUICK)
    text = "\n".join(found.statements)
    assert "Learned from N = 3 samples: 12.0 (9.5, 14.5) low-level actions" in text
    assert "costs actions" in text and "3 false declarations in 18 missions" in text
    assert "Learned from N = 100 samples: 0.0 (0.0, 0.0)" in text
    assert "Hand-written numbers: 0.0 (0.0, 0.0) low-level actions" in text
    assert "Model error of T: 0.120 (0.095, 0.145) after N = 3" in text
    figures = {(f.name, f.params["samples"]): f.value for f in bench._learning(rows)}
    assert figures["more LL actions than true models", 3] == pytest.approx(12.0)
    assert figures["intervals holding the truth", 100] == pytest.approx(10 / 12)
    assert "0.833" in text  # 10 of 12 intervals
    assert {"learning_error", "learning_ll_actions", "learning_duration_s"} == set(found.figures)
    assert [cells[0] for cells in found.tables[1].rows] == ["true", "hand-written"] + 2 * [
        "learned"
    ]


def test_the_chances_of_missions_with_the_true_models_widen_what_is_said_of_losses() -> None:
    rows: List[Dict[str, Any]] = []
    for seed in range(20):
        rows.append(row(seed, "true", 0, 0, 10 + 8 * (seed % 2)))  # by chance
        rows += [row(seed, "learned", 1000, training, 13) for training in range(1, 8)]
    loss = Groups(rows).loss(1000, "ll_actions")
    assert loss is not None and loss.value == pytest.approx(-1.0)
    assert loss.low < -2.0 and loss.high > 0.0  # all training phases alike, and yet not certain


def test_rows_of_an_unfinished_sweep_are_told_as_far_as_they_go() -> None:
    found = Learning().findings([row(1, "learned", 3, 1, 5), row(1, "learned", 10, 1, 5)], QUICK)
    assert "Model error" in found.statements[0]
    only_true = Learning().findings([row(1, "true", 0, 0, 5)], QUICK)
    assert only_true.statements == [] and not only_true.figures
