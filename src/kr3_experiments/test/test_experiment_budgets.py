"""The table of counted budgets, and the points of `accuracy` that come from it."""
from pathlib import Path

import pytest
import yaml

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.accuracy import Accuracy, stored_budgets
from kr3_experiments.experiment.budgets import load_budgets
from kr3_experiments.experiment.definition import Options

TABLE = {
    "machine": "m",
    "commit": "c",
    "seconds": [1.0, 10.0],
    "floors": [
        {
            "rooms": 2,
            "cells": 8,
            "backups": [5, 50],
            "prospects": [7, 70],
            "decisions": 9.5,
            "most_used": 30,
        },
        {"rooms": 36, "cells": 144, "backups": [], "prospects": [3, 30], "most_used": 99},
    ],
}


def written(folder: Path, table: object) -> Path:
    path = folder / "budgets.yaml"
    path.write_text(yaml.safe_dump(table))
    return path


def test_points_have_the_counted_budgets_of_their_floor(tmp_path: Path) -> None:
    budgets = load_budgets(written(tmp_path, TABLE))
    points = Accuracy(budgets).points(Options())
    found = {
        (point.label["method"], point.label["rooms"], point.label["seconds"]): point
        for point in points
        if point.label["noise"] == 1.0
    }
    assert len(points) == 2 * len(found) == 2 * (9 + 4 + 2)  # PA everywhere
    ahead = found["pomdp1", 2, 10.0]
    assert ahead.job["flat_backups"] == 50 and ahead.job["flat_planning"] == "ahead"
    online = found["pomdp1_online", 36, 1.0]
    assert online.job["online_prospects"] == 3 and online.job["method"] == "pomdp1"
    assert ("pomdp1", 36, 1.0) not in found  # its flat model is refused
    trials = {key: len(point.all_seeds()) for key, point in found.items()}
    assert trials["pa", 36, 0.0] == trials["pomdp1", 2, 10.0] == 1000
    assert trials["pomdp1_online", 2, 10.0] == 100
    assert trials["pomdp1_online", 36, 1.0] == 334
    assert trials["pomdp1_online", 36, 10.0] == 34


def test_fewer_trials_are_fewer_for_what_takes_long_too(tmp_path: Path) -> None:
    points = Accuracy(load_budgets(written(tmp_path, TABLE))).points(Options(trials=150))
    trials = {
        (point.label["method"], point.label["rooms"], point.label["seconds"]): len(
            point.all_seeds()
        )
        for point in points
    }
    assert trials["pa", 36, 0.0] == trials["pomdp1_online", 2, 1.0] == 150
    assert trials["pomdp1_online", 36, 1.0] == 50
    assert trials["pomdp1_online", 2, 10.0] == trials["pomdp1_online", 36, 10.0] == 15


def test_the_report_prints_the_calibration(tmp_path: Path) -> None:
    table = load_budgets(written(tmp_path, TABLE)).table()
    assert "measured on m at c" in table.title
    assert ["8", "POMDP-1 ahead", "5 backups", "50 backups", ""] in table.rows
    assert ["144", "POMDP-1 online", "3 prospects an action", "30 prospects an action", "99"] in (
        table.rows
    )


def test_the_stored_table_can_be_read() -> None:
    budgets = stored_budgets()
    assert {2, 4, 6} <= set(budgets.floors)  # those of --quick
    assert all(floor.cells == 4 * rooms for rooms, floor in budgets.floors.items())
    assert not any(floor.backups for rooms, floor in budgets.floors.items() if rooms > 9)


@pytest.mark.parametrize(
    "key, value, message",
    [
        ("floors", None, "'floors': found None, expected a list of floors"),
        ("seconds", [], "'seconds': found .* expected positive numbers"),
        ("seconds", [1.0, "x"], "expected positive numbers"),
        ("seconds", [1.0], "'backups': found .* expected 1 positive numbers"),
        ("floors", [{"rooms": 0}], "'rooms': found 0"),
    ],
)
def test_a_wrong_table_is_refused(tmp_path: Path, key: str, value: object, message: str) -> None:
    with pytest.raises(Kr3Error, match=message):
        load_budgets(written(tmp_path, {**TABLE, key: value}))


def test_a_missing_table_is_refused(tmp_path: Path) -> None:
    with pytest.raises(Kr3Error, match="none.yaml: No such file"):
        load_budgets(tmp_path / "none.yaml")
    (tmp_path / "text.yaml").write_text("words")
    with pytest.raises(Kr3Error, match="found no table"):
        load_budgets(tmp_path / "text.yaml")
