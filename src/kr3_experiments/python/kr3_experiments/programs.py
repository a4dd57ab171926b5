"""The workspace's programs."""
import os
from pathlib import Path

from kr3_experiments.errors import Kr3Error


def find_program(package: str, name: str) -> str:
    """Path of a program in the workspace that was sourced. @throws Kr3Error  there is none"""
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix) / "lib" / package / name
        if prefix and path.exists():
            return str(path)
    raise Kr3Error(f"{name} is not built: run ./kr3 build")
