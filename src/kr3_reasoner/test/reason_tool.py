"""Where the tests find kr3_reason."""

import os
import subprocess
from pathlib import Path

import pytest

TIMEOUT_S = 60


def tool():
    """The program of the workspace that is sourced."""
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":"):
        program = Path(prefix) / "lib/kr3_reasoner/kr3_reason"
        if program.is_file():
            return program
    pytest.skip("the workspace is not built or its setup.bash is not sourced")
    return None


def run(*arguments):
    """Runs kr3_reason and gives its exit code and texts."""
    return subprocess.run(
        [str(tool()), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
