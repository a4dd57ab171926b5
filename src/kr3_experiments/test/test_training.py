"""`./kr3 train` refuses what it cannot learn from before it renders anything, and tells its figures class by class."""
import argparse

import pytest

from kr3_experiments import training
from kr3_experiments.errors import Kr3Error


@pytest.fixture
def root(tmp_path, monkeypatch):
    """A repository with two domains that have the same objects, the second with links to the first."""
    monkeypatch.setenv("KR3_ROOT", str(tmp_path))
    for name, texture in (("first", "mug.png"), ("second", "../first/mug.png")):
        folder = tmp_path / "domains" / name
        folder.mkdir(parents=True)
        (folder / "building.yaml").write_text("name: x\n")
        (folder / "objects.yaml").write_text(
            f"objects:\n  - {{name: mug, class: mug, texture: {texture}}}\n"
        )
    (tmp_path / "domains" / "first" / "mug.png").write_bytes(b"a picture")
    return tmp_path


def options(*arguments):
    parser = argparse.ArgumentParser()
    training.add_options(parser)
    return parser.parse_args(arguments)


def test_a_domain_without_objects_is_refused_with_those_that_have_some(root):
    (root / "domains" / "third").mkdir()
    with pytest.raises(Kr3Error, match="third/building.yaml is missing; .* are first, second"):
        training.run(options("third"))


def test_a_domain_may_be_given_by_its_path(root):
    folder = root / "domains" / "first"
    assert training.domain_folder(str(folder)) == folder.resolve()
    with pytest.raises(Kr3Error, match="there is no folder '.*/elsewhere'"):
        training.domain_folder(str(root / "elsewhere"))


def test_a_seed_of_the_pictures_to_check_with_is_refused(root):
    with pytest.raises(Kr3Error, match="--seed 10000: expected a number from 0 to 9999"):
        training.run(options("first", "--seed", "10000"))


def test_the_same_objects_may_have_their_textures_anywhere(root):
    folders = [training.domain_folder(name) for name in ("first", "second")]
    training.require_same_objects(folders)


def test_other_objects_need_a_model_of_their_own(root):
    (root / "domains" / "second" / "objects.yaml").write_text(
        "objects:\n  - {name: mug, class: pot, texture: ../first/mug.png}\n"
    )
    with pytest.raises(Kr3Error, match=r"second/objects.yaml: not the objects of first \(mug"):
        training.run(options("first", "--also-in", "second"))


@pytest.mark.parametrize("text", ["objects: [", "objects: [{name: mug}]", "[]"])
def test_a_malformed_objects_file_is_named(root, text):
    (root / "domains" / "second" / "objects.yaml").write_text(text)
    with pytest.raises(Kr3Error, match="second/objects.yaml: "):
        training.run(options("first", "--also-in", "second"))


def test_the_table_has_a_line_a_set_and_a_column_a_class():
    score = {"precision": 0.98, "recall": 0.9}
    figures = {
        "threshold": 0.5,
        "sets": [
            {
                "set": "easy",
                "all": score,
                "classes": {"mug": score},
                "brier": 0.0123,
                "cpu_ms": {"median": 17.04, "p95": 30.0},
            },
            {
                "set": "home",
                "all": score,
                "classes": {"pot": score},
                "brier": 0.02,
                "cpu_ms": {"median": 9.0, "p95": 30.0},
            },
        ],
    }
    _, heading, easy, home = training.table(figures)
    assert heading.split() == ["set", "all", "mug", "pot", "Brier", "CPU", "ms"]
    assert easy.split() == "easy 0.980 / 0.900 0.980 / 0.900 - 0.012 17.0".split()
    assert home.split() == "home 0.980 / 0.900 - 0.980 / 0.900 0.020 9.0".split()
