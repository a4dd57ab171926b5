"""`./kr3 replay`: bags that cannot be used are named, and our reference bag is decided the same again."""
import json
import shutil
import subprocess
from pathlib import Path

import genpy
import pytest
import rosbag
from std_msgs.msg import String

from kr3_experiments import cli
from kr3_experiments.mission_inputs import input_lines, line_of

MissionInput = pytest.importorskip("kr3_msgs.msg", reason="no sourced workspace").MissionInput

REFERENCE = Path(__file__).resolve().parents[3] / "rosbag" / "reference.bag"


def message(sequence=0, kind=MissionInput.TOLD, data="{}", stamp_s=1.25):
    """A recorded input."""
    result = MissionInput(sequence=sequence, kind=kind, data=data)
    result.header.stamp = genpy.Time.from_sec(stamp_s)
    return result


def write_bag(file, messages, topic="executive/inputs"):
    """A bag with these messages on one topic."""
    with rosbag.Bag(str(file), "w") as bag:
        for item in messages:
            bag.write(topic, item, genpy.Time.from_sec(1.0))
    return file


def replay(*arguments):
    """Exit code of `./kr3 replay`."""
    return cli.main(["replay", *[str(argument) for argument in arguments]])


def compared_with(lines):
    """The lines below a decision that differs: what was decided then, and what now."""
    return [line.strip() for line in lines if line.strip().startswith(("then ", "now "))]


needs_tool = pytest.mark.skipif(
    shutil.which("rosrun") is None
    or subprocess.run(
        ["rosrun", "kr3_executive", "kr3_replay", "--help"], capture_output=True, check=False
    ).returncode
    != 0,
    reason="kr3_replay is not built, or the workspace is not sourced",
)


def test_an_input_keeps_all_its_digits():
    line = json.loads(line_of(message(3, MissionInput.DECISION, '{"p": 0.1234567890123456789}')))
    assert line["sequence"] == 3
    assert line["kind"] == "DECISION"
    assert line["stamp_s"] == 1.25
    assert line["data"]["p"] == 0.1234567890123456789


def test_inputs_are_found_on_any_topic(tmp_path):
    file = write_bag(tmp_path / "a.bag", [message(0), message(1)], "/robot1/executive/inputs")
    assert [json.loads(line)["sequence"] for line in input_lines(file)] == [0, 1]


def test_what_is_no_bag_is_named(tmp_path, capsys):
    assert replay(tmp_path / "none.bag") == 2
    (tmp_path / "text.bag").write_text("no bag")
    assert replay(tmp_path / "text.bag", "--check") == 2
    written = capsys.readouterr().err
    assert "none.bag: No such file" in written
    assert "text.bag is not a bag" in written


def test_a_bag_without_inputs_is_named(tmp_path, capsys):
    file = write_bag(tmp_path / "old.bag", [String("hello")], "chatter")
    assert replay(file) == 2
    assert "old.bag holds no inputs of a mission" in capsys.readouterr().err


@pytest.mark.parametrize(
    "broken, why",
    [
        (message(4, data='{"reason": "canc'), "input 4 (TOLD): the data are no JSON"),
        (message(5, kind=99), "input 5: kind 99"),
    ],
)
def test_a_malformed_input_is_named(tmp_path, capsys, broken, why):
    assert replay(write_bag(tmp_path / "broken.bag", [broken])) == 2
    assert why in capsys.readouterr().err


def test_a_damaged_bag_is_named(tmp_path, capsys):
    file = write_bag(tmp_path / "cut.bag", [message(i) for i in range(500)])
    file.write_bytes(file.read_bytes()[:-3000])
    assert replay(file) == 2
    assert "cut.bag" in capsys.readouterr().err


def test_the_reference_bag_is_small():
    assert REFERENCE.stat().st_size < 300_000


@needs_tool
def test_the_reference_bag_is_decided_the_same_again(capfd):
    """After a change that is meant to change decisions: record it anew (rosbag/README.md)."""
    code = replay(REFERENCE, "--any-numbers")
    output = capfd.readouterr().out
    assert code == 0, output
    assert "finish: achieved" in output


@needs_tool
def test_an_observation_that_is_altered_changes_the_decisions_after_it(capfd):
    inputs = [json.loads(line) for line in input_lines(REFERENCE)]
    seen = next(
        item["sequence"]
        for item in inputs
        if item["kind"] == "SKILL_RESULT"
        and item["data"]["action"].startswith("search(")
        and item["data"]["observation"] == ["true"]
    )
    code = replay(REFERENCE, "--set", f"{seen}.observation=false", "--any-numbers")
    lines = capfd.readouterr().out.splitlines()
    assert code == 1
    compared = [line for line in lines if "  step " in line]
    before = [line for line in compared if int(line.split()[0]) < seen]
    assert before and all(" differs" not in line for line in before)
    assert any(" differs" in line for line in compared)
    now = next(line for line in compared_with(lines) if line.startswith("now "))
    assert "grasp(" not in now  # it looks on instead
    assert any(line.startswith("nothing is recorded of ") for line in lines[-4:])


@needs_tool
def test_gaps_and_other_starts_are_named(tmp_path, capfd):
    def cut(name, keep):
        with rosbag.Bag(str(REFERENCE)) as bag:
            inputs = [item for _, item, _ in bag.read_messages(topics=["executive/inputs"])] or [
                item for _, item, _ in bag.read_messages(topics=["/executive/inputs"])
            ]
        return write_bag(tmp_path / name, [item for item in inputs if keep(item.sequence)])

    assert replay(cut("gap.bag", lambda sequence: sequence != 5), "--check") == 2
    assert "expected input 5; inputs are missing" in capfd.readouterr().err
    assert replay(cut("late.bag", lambda sequence: sequence > 2), "--check") == 2
    assert "begins in the middle of a mission" in capfd.readouterr().err
    assert replay(REFERENCE, "--set", "0.version=99", "--check") == 2
    assert "recorded by version 99" in capfd.readouterr().err
