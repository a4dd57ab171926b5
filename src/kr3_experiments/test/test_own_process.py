"""Work in a process of its own ends as it does here, and with its parent."""
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from kr3_experiments.errors import Kr3Error, StartError
from kr3_experiments.learning import command
from kr3_experiments.own_process import in_own_process


def _refuse() -> int:
    raise StartError("no stack")


def test_brings_what_the_work_returns_from_another_process() -> None:
    assert in_own_process(lambda: {"of": os.getpid()})["of"] != os.getpid()


def test_errors_keep_their_kind_and_their_words() -> None:
    with pytest.raises(StartError, match="no stack"):
        in_own_process(_refuse)


@pytest.mark.parametrize(
    ("work", "how"),
    [
        (lambda: os._exit(3), "exit code 3"),
        (lambda: os.kill(os.getpid(), signal.SIGKILL), "signal SIGKILL"),
        (lambda: 1 // 0, "exit code 1"),
    ],
)
def test_an_end_without_a_word_is_told(work, how: str) -> None:
    with pytest.raises(Kr3Error, match=how):
        in_own_process(work)


def test_the_work_ends_with_its_parent_however_that_ends(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    program = f"""
        import os, time
        from pathlib import Path
        from kr3_experiments.own_process import in_own_process

        def work():
            Path({str(note)!r}).write_text(str(os.getpid()))
            time.sleep(60)

        in_own_process(work)
    """
    parent = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)])
    deadline = time.monotonic() + 20
    while not (note.exists() and note.read_text()) and time.monotonic() < deadline:
        time.sleep(0.05)
    child = int(note.read_text())
    parent.kill()
    parent.wait()
    while Path(f"/proc/{child}").exists() and time.monotonic() < deadline:
        if Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z":
            break  # whoever reaps orphans here is slow
        time.sleep(0.05)
    else:
        assert not Path(f"/proc/{child}").exists()


def test_worlds_that_bring_nothing_end_the_training() -> None:
    left = iter([50, 40, 40, 41, 40, 40, 40, 40])
    with pytest.raises(Kr3Error, match="5 worlds brought no trial that is wanted; 40 are left"):
        command._through_worlds(lambda: next(left))
    assert next(left) == 40
    some = iter([50, 50, 50, 50, 50, 49, 49, 0])
    command._through_worlds(lambda: next(some))
    assert next(some, None) is None
