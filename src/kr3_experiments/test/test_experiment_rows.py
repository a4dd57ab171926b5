"""Rows of experiments survive interruptions and damage; only what is damaged is lost."""
from pathlib import Path
from typing import Any, Dict

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.rows import RowStore

LABELS = {"method": str, "rooms": int}


def row(seed: int, **changes: Any) -> Dict[str, Any]:
    values: Dict[str, Any] = {
        "method": "pa",
        "rooms": 4,
        "config": "c1",
        "commit": "abc",
        "seed": seed,
        "truth": "f = 1",
        "declared": True,
        "goal_true": False,
        "hl_actions": 3,
        "ll_actions": 7,
        "duration_s": 0.1 + seed,
        "backups": 12,
        "policies": "p1 p2",
        "reason": 'no plan is left, "really"',
    }
    return {**values, **changes}


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    store = RowStore(tmp_path, LABELS)
    store.add([row(1), row(2)])
    again = RowStore(tmp_path, LABELS)
    assert again.rows == [row(1), row(2)]
    assert again.has("c1", 2) and not again.has("c1", 3) and not again.has("c2", 1)
    assert not again.rejected_path.exists()


def test_words_of_several_lines_are_one_row(tmp_path: Path) -> None:
    RowStore(tmp_path, LABELS).add([row(1, reason="it ended:\nno map\u2028\r\n")])
    again = RowStore(tmp_path, LABELS)
    assert [kept["reason"] for kept in again.rows] == ["it ended: no map "] and not again.rejected


def test_a_trial_is_kept_once(tmp_path: Path) -> None:
    store = RowStore(tmp_path, LABELS)
    store.add([row(1)])
    store.add([row(1, reason="again"), row(2)])
    assert [kept["seed"] for kept in RowStore(tmp_path, LABELS).rows] == [1, 2]


def test_rows_come_by_configuration_and_seed(tmp_path: Path) -> None:
    store = RowStore(tmp_path, LABELS)
    store.add([row(2), row(1, config="c2"), row(1)])
    found = [(kept["config"], kept["seed"]) for kept in store.of(["c2", "c1"])]
    assert found == [("c2", 1), ("c1", 1), ("c1", 2)]


@pytest.mark.parametrize(
    "damage, what",
    [
        (lambda text: text[:-9], "cut short"),
        (lambda text: text + "a,b\n", "found 2 fields, expected 14"),
        (lambda text: text.replace(",7,", ",seven,", 1), "column ll_actions: found 'seven'"),
        (lambda text: text.replace(",1,0,", ",2,0,", 1), "column declared: found '2'"),
        (lambda text: text + text.splitlines(keepends=True)[-1], "is there already"),
    ],
)
def test_damage_is_named_and_kept_aside_and_the_rest_is_used(
    tmp_path: Path, damage: Any, what: str
) -> None:
    store = RowStore(tmp_path, LABELS)
    store.add([row(1), row(2), row(3)])
    store.path.write_text(damage(store.path.read_text()))
    again = RowStore(tmp_path, LABELS)
    assert len(again.rejected) == 1 and what in again.rejected[0]
    assert "rows.csv:" in again.rejected[0]
    assert len(again.rows) >= 2
    assert what in again.rejected_path.read_text()
    clean = RowStore(tmp_path, LABELS)
    assert clean.rejected == [] and clean.rows == again.rows


def test_a_file_of_other_columns_is_kept_aside(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("colour,seed\nred,1\n")
    store = RowStore(tmp_path, LABELS)
    assert store.rows == [] and "found the columns colour,seed" in store.rejected[0]
    assert "red,1" in store.rejected_path.read_text()


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(Kr3Error, match="cannot write results to .*file"):
        RowStore(tmp_path / "file" / "results", LABELS)
