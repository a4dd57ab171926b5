"""Child processes end when they should, and leave nobody behind."""
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from kr3_experiments.errors import StackError
from kr3_experiments.processes import (
    ManagedProcess,
    Supervisor,
    describe_exit,
    end_processes,
)

QUICK = ((signal.SIGINT, 1.0), (signal.SIGTERM, 1.0), (signal.SIGKILL, 2.0))


def wait_for(condition, timeout_s=10.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "did not happen in time"
        time.sleep(0.01)


def start(tmp_path, script, name="node"):
    """A fake node: a shell script in a process of its own."""
    return ManagedProcess(name, ["bash", "-c", script], tmp_path / f"{name}.log", os.environ)


def is_alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    return state != "Z"


def test_an_obedient_process_ends_on_sigint_and_is_not_killed(tmp_path):
    process = start(
        tmp_path, "trap 'echo bye; exit 0' INT; echo ready; while :; do sleep 0.02; done"
    )
    wait_for(lambda: "ready" in process.log_tail())
    assert end_processes([process], QUICK) == []
    assert process.exit_code() == 0
    assert "bye" in process.log_tail()


def test_a_deaf_process_is_killed(tmp_path):
    process = start(tmp_path, "trap '' INT TERM; echo ready; while :; do sleep 0.02; done")
    wait_for(lambda: "ready" in process.log_tail())
    assert end_processes([process], ((signal.SIGINT, 0.1), (signal.SIGTERM, 0.1), *QUICK[2:])) == [
        process
    ]
    assert process.exit_code() == -signal.SIGKILL


def test_grandchildren_end_with_their_group(tmp_path):
    process = start(tmp_path, "trap '' INT; sleep 1000 & echo $!; wait")
    wait_for(lambda: process.log_tail().strip().isdigit())
    grandchild = int(process.log_tail())
    end_processes([process], ((signal.SIGINT, 0.1), *QUICK[1:]))
    wait_for(lambda: not is_alive(grandchild))


def test_children_end_when_their_parent_is_killed(tmp_path):
    parent_code = textwrap.dedent(
        """
        import os, sys, time
        from pathlib import Path
        from kr3_experiments.processes import ManagedProcess
        child = ManagedProcess("node", ["sleep", "1000"], Path(sys.argv[1]), os.environ)
        print(child.pid, flush=True)
        time.sleep(1000)
        """
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[1] / "python")}
    parent = subprocess.Popen(
        [sys.executable, "-c", parent_code, str(tmp_path / "node.log")],
        stdout=subprocess.PIPE,
        env=environment,
        text=True,
    )
    child = int(parent.stdout.readline())
    assert is_alive(child)
    parent.kill()
    parent.wait()
    parent.stdout.close()
    wait_for(lambda: not is_alive(child))


def test_a_node_that_dies_is_restarted_a_bounded_number_of_times(tmp_path):
    lines = []
    supervisor = Supervisor(lines.append)
    supervisor.add(start(tmp_path, "echo started; exit 3"), max_restarts=2)
    with pytest.raises(StackError, match=r"node ended after 2 restarts \(exit code 3\)") as error:
        deadline = time.monotonic() + 10.0
        while time.monotonic() < deadline:
            supervisor.poll()
            time.sleep(0.01)
    assert [line.split(": ")[1] for line in lines] == ["restart 1 of 2", "restart 2 of 2"]
    assert str(error.value).count("started") == 3  # the end of its log is shown


def test_the_end_of_a_process_that_may_not_be_restarted_ends_the_stack(tmp_path):
    supervisor = Supervisor()
    process = start(tmp_path, "kill -SEGV $$", name="the ROS master")
    supervisor.add(process)
    wait_for(lambda: process.exit_code() is not None)
    with pytest.raises(StackError, match=r"the ROS master ended \(signal SIGSEGV\)"):
        supervisor.poll()


def test_during_the_start_nothing_is_restarted(tmp_path):
    supervisor = Supervisor()
    process = start(tmp_path, "echo no such file; exit 1")
    supervisor.add(process, max_restarts=3)
    wait_for(lambda: process.exit_code() is not None)
    with pytest.raises(StackError, match="ended during the start(.|\n)*no such file"):
        supervisor.raise_if_ended()


def test_ending_twice_is_harmless(tmp_path):
    supervisor = Supervisor()
    process = start(tmp_path, "sleep 1000")
    supervisor.add(process)
    supervisor.end()
    supervisor.end()
    assert process.is_gone()


@pytest.mark.parametrize(
    "code, text",
    [(0, "exit code 0"), (2, "exit code 2"), (-9, "signal SIGKILL"), (-99, "signal 99")],
)
def test_exits_are_described(code, text):
    assert describe_exit(code) == text
