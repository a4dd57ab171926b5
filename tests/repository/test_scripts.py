"""The entry script answers at once, and the summary of ./kr3 test counts rightly."""
import os
import subprocess
import sys
import time

import pytest
from repository import ROOT

PASSED = '<testcase classname="c" name="good"/>'
FAILED = '<testcase classname="c" name="bad"><failure message="1 is not 2"/></testcase>'
SKIPPED = '<testcase classname="c" name="off"><skipped/></testcase>'


def kr3(*arguments):
    started = time.monotonic()
    result = subprocess.run([str(ROOT / "kr3"), *arguments], capture_output=True, text=True)
    return result, time.monotonic() - started


def summary(tmp_path, **files):
    for name, cases in files.items():
        folder = tmp_path / "package"
        folder.mkdir(exist_ok=True)
        (folder / f"{name}.xml").write_text(cases)
    script = str(ROOT / "scripts" / "test_summary.py")
    return subprocess.run([sys.executable, script, str(tmp_path)], capture_output=True, text=True)


def test_help_lists_every_command_within_a_second():
    result, seconds = kr3("--help")
    assert result.returncode == 0
    assert seconds < 1.0
    for (
        command
    ) in "demo test setup build up goal status record replay reason map doctor fuzz".split():
        assert f"  {command}" in result.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["nonsense"],
        ["build", "--nonsense"],
        ["test", "--nonsense"],
        ["fuzz", "nonsense"],
        ["fuzz", "pomdp", "--nonsense"],
    ],
)
def test_what_is_unknown_is_refused(arguments):
    result, _ = kr3(*arguments)
    assert result.returncode == 1
    assert "nonsense" in result.stderr


def test_no_command_shows_the_usage_and_fails():
    result, _ = kr3()
    assert result.returncode == 2
    assert "Usage" in result.stdout


@pytest.mark.parametrize("script", ["kr3", ".ci/run", "scripts/build.sh", "scripts/setup.sh"])
def test_scripts_are_executable(script):
    assert os.access(ROOT / script, os.X_OK)


def test_the_last_line_counts_passed_and_failed(tmp_path):
    suite = f"<testsuites><testsuite>{PASSED}{PASSED}{SKIPPED}</testsuite></testsuites>"
    result = summary(tmp_path, a=suite, b=f"<testsuite>{PASSED}{FAILED}</testsuite>")
    assert result.stdout.splitlines()[-1] == "3 passed, 1 failed"
    assert "FAILED package: c.bad: 1 is not 2" in result.stdout
    assert result.returncode == 1


def test_success_needs_at_least_one_test(tmp_path):
    assert summary(tmp_path).returncode == 1
    assert summary(tmp_path, a=f"<testsuite>{PASSED}</testsuite>").returncode == 0


def test_an_unreadable_result_is_a_failure(tmp_path):
    result = summary(tmp_path, a="<testsuite>", b=f"<testsuite>{PASSED}</testsuite>")
    assert result.stdout.splitlines()[-1] == "1 passed, 1 failed"
