"""./kr3 up on a small stack of foreign nodes: what a person sees when things go wrong, and that nothing stays behind.

Needs the sourced workspace (./kr3 test has it).
"""
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from kr3_experiments.bringup import STATE_FILE
from kr3_experiments.master import free_port

ROOT = Path(__file__).resolve().parents[3]
DOMAIN = sorted(file.parent for file in (ROOT / "domains").glob("*/scenario.yaml"))[0]
CLI = shutil.which("rosrun") and ["rosrun", "kr3_experiments", "kr3_cli"]

pytestmark = pytest.mark.skipif(
    CLI is None
    or subprocess.run(["rospack", "find", "kr3_experiments"], capture_output=True).returncode != 0,
    reason="the workspace is not sourced",
)

MUX = """
nodes:
  - {name: mux_node, package: topic_tools, executable: mux, arguments: [out, in], ready: [{service: mux/select}]}
"""


@pytest.fixture
def repository(tmp_path):
    """A repository with one domain that has a map, and a small stack file."""
    shutil.copytree(
        DOMAIN, tmp_path / "domains" / "office", ignore=shutil.ignore_patterns("textures")
    )
    (tmp_path / "domains" / "office" / "map.bt").write_bytes(b"map")
    (tmp_path / "stack.yaml").write_text(MUX)
    yield tmp_path
    for process in Program.running:
        process.terminate()
        process.wait(30)
    Program.running.clear()


class Program:
    """A running kr3_cli with its output in a file; `repository` ends it after the test."""

    running = []

    def __init__(self, repository, *arguments):
        self.output = repository / "output"
        environment = {**os.environ, "KR3_ROOT": str(repository), "ROS_IP": "127.0.0.1"}
        with self.output.open("wb") as output:
            self.process = subprocess.Popen(
                [*CLI, *arguments],
                stdout=output,
                stderr=output,
                env=environment,
                start_new_session=True,
            )
        self.running.append(self.process)

    def text(self):
        return self.output.read_text()

    def wait_for(self, pattern, timeout_s=30.0):
        deadline = time.monotonic() + timeout_s
        while not re.search(pattern, self.text()):
            assert self.process.poll() is None and time.monotonic() < deadline, self.text()
            time.sleep(0.05)

    def exit_code(self, timeout_s=30.0):
        return self.process.wait(timeout_s)

    def children(self):
        listing = subprocess.run(
            ["ps", "--ppid", str(self.process.pid), "-o", "pid=,args="],
            capture_output=True,
            text=True,
        )
        return {int(line.split()[0]): line for line in listing.stdout.splitlines()}


def start_up(repository, port):
    return Program(repository, "up", "--stack", str(repository / "stack.yaml"), "--port", str(port))


def assert_gone(pids):
    left = [pid for pid in pids if Path(f"/proc/{pid}").exists()]
    assert left == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_stack_and_leaves_no_process(repository, number):
    program = start_up(repository, free_port())
    program.wait_for("The robot is ready")
    assert (repository / "runs" / "current.json").exists()
    children = program.children()
    assert len(children) == 3, children  # master, rosout, mux
    program.process.send_signal(number)
    assert program.exit_code() == 128 + number
    assert f"interrupted by {number.name}" in program.text()
    assert_gone(children)
    assert not (repository / "runs" / "current.json").exists()


def test_the_death_of_the_master_ends_the_stack_and_is_said(repository):
    program = start_up(repository, free_port())
    program.wait_for("The robot is ready")
    children = program.children()
    (master,) = [pid for pid, line in children.items() if "rosmaster" in line]
    os.kill(master, signal.SIGKILL)
    assert program.exit_code() == 1
    assert "the ROS master ended (signal SIGKILL)" in program.text()
    assert_gone(children)


def test_a_node_that_dies_is_restarted_and_answers_again(repository):
    program = start_up(repository, free_port())
    program.wait_for("The robot is ready")
    (node,) = [pid for pid, line in program.children().items() if "/mux " in line]
    os.kill(node, signal.SIGKILL)
    program.wait_for("mux_node ended .signal SIGKILL.: restart 1 of 3")
    deadline = time.monotonic() + 20.0
    while not any("/topic_tools/mux " in line for line in program.children().values()):
        assert time.monotonic() < deadline, program.children()
        time.sleep(0.05)
    program.process.send_signal(signal.SIGINT)
    assert program.exit_code() == 130


def test_a_second_master_on_the_port_is_refused(repository):
    port = free_port()
    first = start_up(repository, port)
    first.wait_for("The robot is ready")
    second = subprocess.run(
        [*CLI, "up", "--stack", str(repository / "stack.yaml"), "--port", str(port)],
        env={**os.environ, "KR3_ROOT": str(repository)},
        capture_output=True,
        text=True,
        timeout=30,
    )
    assert second.returncode == 1
    assert f"port {port} is in use by another ROS master" in second.stderr
    first.process.send_signal(signal.SIGINT)
    assert first.exit_code() == 130


def test_a_node_that_cannot_start_is_named_with_its_log(repository):
    (repository / "stack.yaml").write_text(MUX.replace("[out, in]", "[]"))
    program = start_up(repository, free_port())
    assert program.exit_code() == 3
    assert re.search(r"mux_node ended during the start .exit code \d+", program.text())
    assert "usage: mux" in program.text()
    assert "Traceback" not in program.text()


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("executable: mux", "executable: muks", "package topic_tools has no executable 'muks'"),
        (
            "package: topic_tools",
            "package: moon",
            "package moon( of mux_node)? is not in the workspace",
        ),
    ],
)
def test_a_program_that_is_not_there_is_named(repository, old, new, message):
    (repository / "stack.yaml").write_text(MUX.replace(old, new))
    program = start_up(repository, free_port())
    assert program.exit_code() == 1
    assert re.search(message, program.text())
    assert "Traceback" not in program.text()


def test_a_node_that_never_gets_ready_is_named_with_what_is_missing(repository):
    text = MUX.replace("mux/select}]", "mux/nothing}], ready_timeout_s: 1")
    (repository / "stack.yaml").write_text(text)
    program = start_up(repository, free_port())
    assert program.exit_code() == 3
    assert "mux_node was not ready within 1 s (no service 'mux/nothing')" in program.text()


@pytest.mark.parametrize(
    "arguments, exit_code, message",
    [
        (["demo", "--target-at", "moon"], 1, "'moon' is no place of the domain office"),
        (["demo", "--start", "moon"], 1, "'moon' is no place of the domain office"),
        (["demo", "--bring-to", "moon"], 1, "'moon' is no place of the domain office"),
        (["demo", "--bring-to", "kitchen", "--goal", "x = y"], 1, "--goal and --bring-to"),
        (["demo", "--domain", "moon"], 1, "there is no domain 'moon'"),
        (["up", "--port", "70000"], 1, "port 70000 cannot be used"),
        (["status"], 1, "no robot is running"),
        (["goal", "x = y"], 1, "no robot is running"),
        (["record"], 1, "no robot is running"),
        (["replay", "none.bag"], 2, "none.bag: No such file"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_requests_are_refused_in_words(repository, arguments, exit_code, message):
    shutil.copytree(ROOT / "rosbag", repository / "rosbag")
    program = Program(repository, *arguments)
    assert program.exit_code() == exit_code
    assert message in program.text()
    assert "Traceback" not in program.text()


def test_a_folder_with_an_earlier_mission_is_not_used_again(repository):
    (repository / "domains" / "office" / "perception.yml.gz").write_bytes(b"")
    folder = repository / "earlier"
    folder.mkdir()
    (folder / STATE_FILE).write_text("{}")
    program = Program(repository, "demo", "--no-bag", "--run-dir", str(folder))
    assert program.exit_code() == 1
    assert "holds an earlier mission (executive_state.json)" in program.text()


def test_a_missing_map_is_said_before_anything_starts(repository):
    (repository / "domains" / "office" / "map.bt").unlink()
    program = start_up(repository, free_port())
    assert program.exit_code() == 1
    assert "build it with ./kr3 map office" in program.text()
    assert not (repository / "runs").exists()
