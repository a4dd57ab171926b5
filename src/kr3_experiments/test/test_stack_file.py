"""Stack files are read strictly."""
from pathlib import Path

import pytest

from kr3_experiments.errors import Kr3Error
from kr3_experiments.stack_file import Follow, ReadyKind, load_stack, substitute

CONFIG = Path(__file__).resolve().parents[1] / "config"
VARIABLES = {
    "domain_dir": "/d",
    "run_dir": "/r",
    "map_out": "/d/map.bt",
    "seed": 7,
    "placements": ["a=b"],
    "method": "pa",
    "models": "/d/models_learned.yaml",
    "scenario": "/d/scenario.yaml",
    "robot_start": [1.0, 2.0, 0.5],
    "real_time_factor": 4.0,
}


def written(tmp_path, text):
    file = tmp_path / "stack.yaml"
    file.write_text(text)
    return file


def test_a_lone_placeholder_keeps_its_type():
    assert substitute({"a": "{seed}", "b": ["x{seed}y"]}, VARIABLES) == {"a": 7, "b": ["x7y"]}


@pytest.mark.parametrize("file", sorted(CONFIG.glob("*stack.yaml")), ids=lambda file: file.name)
def test_our_own_files_load_and_every_node_has_a_ready_sign(file):
    nodes = load_stack(file, VARIABLES)
    assert nodes
    assert [node.name for node in nodes if not node.ready] == []


def test_nodes_are_read_with_defaults(tmp_path):
    text = "nodes: [{name: n, package: p, parameters: {s: '{seed}'}, ready: [{action: act}]}]"
    (node,) = load_stack(written(tmp_path, text), VARIABLES)
    assert (node.executable, node.max_restarts, node.parameters) == ("n", 3, {"s": 7})
    assert (node.ready[0].kind, node.ready[0].name) == (ReadyKind.ACTION, "act")


@pytest.mark.parametrize(
    "text, message",
    [
        ("nodes: 3", "expected a list"),
        ("nodes: [{name: n}]", "needs 'name' and 'package'"),
        ("nodes: [{name: n, package: p, paramters: {}}]", "unknown key 'paramters'"),
        ("nodes: [{name: n, package: p}, {name: n, package: p}]", "two nodes are called n"),
        ("nodes: [{name: n, package: p, ready: [{sign: x}]}]", "a ready sign is one of"),
        ("nodes: [{name: n, package: p, parameters: {a: '{sede}'}}]", "unknown placeholder {sede}"),
        ("nodes: [{name: n, package: p, lockstep: {topic: t}}]", "n: 'lockstep' has follow, param"),
        ("nodes: [{name: n, package: p, lockstep: {follow: t}}]", "needs both follow and period_s"),
        (
            "nodes: [{name: n, package: p, lockstep: {follow: t, period_s: -1}}]",
            "period_s -1: expected a number > 0",
        ),
        ("nodes: [", "not YAML"),
    ],
)
def test_errors_name_the_file_and_the_fault(tmp_path, text, message):
    file = written(tmp_path, text)
    with pytest.raises(Kr3Error) as error:
        load_stack(file, VARIABLES)
    assert str(file) in str(error.value)
    assert message in str(error.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(Kr3Error, match="No such file"):
        load_stack(tmp_path / "none.yaml", VARIABLES)


LOCKSTEP = """
nodes:
  - {name: world, package: p, parameters: {rate: 4},
     lockstep: {parameters: {rate: 0, waits_for: "{lockstep_consumers}"}}}
  - {name: eyes, package: p, lockstep: {follow: seen, period_s: 0.2}}
  - {name: legs, package: p, lockstep: {follow: stood, period_s: 0.1}}
  - {name: talk, package: p}
"""


def test_lockstep_counts_only_when_asked_for(tmp_path):
    world, eyes, _, _ = load_stack(written(tmp_path, LOCKSTEP), VARIABLES)
    assert (world.parameters, eyes.follow) == ({"rate": 4}, None)


def test_in_lockstep_the_simulation_waits_for_the_followed_nodes_that_are_there(tmp_path):
    specs = load_stack(written(tmp_path, LOCKSTEP), VARIABLES, lockstep=True, leave_out=("eyes",))
    assert [spec.name for spec in specs] == ["world", "legs", "talk"]
    assert specs[0].parameters == {"rate": 0, "waits_for": ["legs"]}
    assert [spec.follow for spec in specs] == [None, Follow("stood", 0.1), None]


def test_without_variables_placeholders_stay():
    assert load_stack(CONFIG / "stack.yaml", None)
