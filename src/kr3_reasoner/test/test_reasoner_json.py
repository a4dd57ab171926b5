"""The JSON answers of kr3_reason have the shapes that docs/reasoner_json.md promises, in that order."""

import json
import re
from pathlib import Path

import pytest
from reason_tool import run

PAGE = Path(__file__).resolve().parents[3] / "docs/reasoner_json.md"
DATA = Path(__file__).parent / "data"
LAMPS = str(DATA / "lamps.kr3")
COUNTER = str(DATA / "counter.kr3")
CLASH = ("--assume", "obs(dark, true, 0)", "--assume", "obs(dark, false, 0)")
OFF = [text for bit in range(14) for text in ("--assume", f"init(on({bit}), false)")]
SOON = ("--max-horizon", "1000", "--time-limit", "0.3")
KNOWN = "init(on(left), false).\ninit(on(right), false).\ninit(shows(d) = 1, true).\n"
TYPES = {
    "text": lambda value: isinstance(value, str),
    "bool": lambda value: isinstance(value, bool),
    "int": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "number": lambda value: isinstance(value, (int, float)) and not isinstance(value, bool),
    "null": lambda value: value is None,
}


def shapes():
    blocks = re.findall(r"^```shape (\S+)\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    return {name: json.loads(text) for name, text in blocks}


SHAPES = shapes()


def check_fields(value, shape, where):
    assert isinstance(value, dict), where
    wanted = [name.rstrip("?") for name in shape]
    known = [name for name in value if name in wanted]
    assert known == [name for name in wanted if name in value], f"{where}: another order"
    for name, part in shape.items():
        if name.rstrip("?") in value:
            check(value[name.rstrip("?")], part, f"{where}.{name}")
        else:
            assert name.endswith("?"), f"{where}: no {name}"


def check(value, shape, where):
    if isinstance(shape, dict):
        check_fields(value, shape, where)
    elif isinstance(shape, list):
        assert isinstance(value, list), where
        for index, item in enumerate(value):
            check(item, shape[0], f"{where}[{index}]")
    else:
        kinds = shape.split(" or ")
        named = [kind for kind in kinds if kind in SHAPES]
        if named and isinstance(value, dict):
            check_fields(value, SHAPES[named[0]], where)
        else:
            assert any(TYPES[kind](value) for kind in kinds if kind in TYPES), f"{where}: {value!r}"


def ask(*arguments):
    result = run(*arguments, "--format", "json")
    return result.returncode, json.loads(result.stdout)


@pytest.fixture(name="history")
def history_file(tmp_path):
    file = tmp_path / "known.hist"
    file.write_text(KNOWN + "hpd(flip(left), 0).\nobs(lit(red), false, 1).\n", encoding="utf-8")
    return str(file)


QUESTIONS = [
    (("check", LAMPS), ()),
    (("check", LAMPS, "--history", "HISTORY"), ("records", "current_step")),
    (("translate", LAMPS, "--history", "HISTORY"), ()),
    (("translate", LAMPS, "--history", "HISTORY", "--goal", "on(right)"), ("length",)),
    (("entails", LAMPS, "--history", "HISTORY"), ("literals",)),
    (
        ("entails", LAMPS, "--history", "HISTORY", "--literal", "dark"),
        ("literal", "answer", "possible"),
    ),
    (("explain", LAMPS, "--history", "HISTORY", "--literal", "dark"), ()),
    (("explain", LAMPS, "--literal", "dark"), ()),
    (("models", LAMPS, "--history", "HISTORY"), ()),
    (("diagnose", LAMPS, "--history", "HISTORY"), ("cost", "explanations")),
    (
        ("diagnose", LAMPS, "--history", "HISTORY", "--assume", "obs(on(left), true, 0)"),
        ("conflict",),
    ),
    (("plan", LAMPS, "--history", "HISTORY", "--goal", "lit(green)"), ()),
    (("plan", LAMPS, "--history", "HISTORY", "--goal", "lit(green) and dark"), ()),
    (("relevant", LAMPS, "--history", "HISTORY", "--goal", "lit(green)"), ()),
    (("import-sparc", str(DATA / "delivery.sp")), ()),
]


@pytest.mark.parametrize("question, optional", QUESTIONS, ids=lambda item: "-".join(item[:1]))
def test_answers_have_the_documented_shape(question, optional, history):
    code, answer = ask(*[history if word == "HISTORY" else word for word in question])
    assert code == 0
    shape = SHAPES[question[0]]
    check_fields(answer, shape, question[0])
    assert set(optional) <= set(answer)
    assert set(answer) <= {
        name.rstrip("?") for name in shape
    }, "a field that the page does not have"
    assert answer["command"] == question[0]


def test_every_command_has_its_shape():
    commands = {question[0] for question, _ in QUESTIONS}
    assert commands == set(SHAPES) - {"error", "record", "place", "proof"}


@pytest.mark.parametrize(
    "question, code, name",
    [
        (("plan", LAMPS, "--goal", "lit("), 1, "INVALID_ARGUMENT"),
        (("check", "nowhere.kr3"), 1, "NOT_FOUND"),
        (("models", LAMPS, *CLASH), 1, "FAILED_PRECONDITION"),
        (("plan", COUNTER, *OFF, "--goal", "on(13)", *SOON), 3, "DEADLINE_EXCEEDED"),
    ],
    ids=["wrong", "missing", "inconsistent", "late"],
)
def test_errors_have_their_shape_and_exit_code(question, code, name):
    found, answer = ask(*question)
    check_fields(answer, SHAPES["error"], "error")
    assert (found, answer["error"]["code"]) == (code, name)
    assert answer["error"]["message"]
