"""docs/tutorial_domain.md: whoever pastes its files and types its commands sees what it shows."""

import os
import re
import subprocess
import sys
from pathlib import Path

from reason_tool import TIMEOUT_S, tool

PAGE = Path(__file__).resolve().parents[3] / "docs/tutorial_domain.md"
FENCE = re.compile(r"(?:^File `([^`]+)`:\n)?^```(\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def commands_of(session):
    """The commands of a console block, each with the output below it."""
    parts = re.split(r"^\$ (.*)\n", session, flags=re.MULTILINE)
    return list(zip(parts[1::2], parts[2::2]))


def run(command, directory):
    """The output of a command, errors included, without its final line end."""
    environment = {**os.environ, "PATH": f"{tool().parent}:/usr/bin:{os.environ['PATH']}"}
    return subprocess.run(
        ["/bin/sh", "-c", command],
        cwd=directory,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    ).stdout


def play(page, directory):
    """The page with the output that each command gives today."""

    def replay(match):
        name, kind, text = match.groups()
        if name:
            file = Path(directory) / name
            before = file.read_text(encoding="utf-8") + "\n" if file.exists() else ""
            file.write_text(before + text, encoding="utf-8")
            return match.group(0)
        if kind != "console":
            return match.group(0)
        session = "".join(
            f"$ {command}\n{run(command, directory)}" for command, _ in commands_of(text)
        )
        return f"```console\n{session}```"

    return FENCE.sub(replay, page)


def test_the_tutorial_shows_what_its_commands_print(tmp_path):
    tool()
    page = PAGE.read_text(encoding="utf-8")
    assert len(FENCE.findall(page)) > 15
    assert play(page, tmp_path) == page


if __name__ == "__main__":  # brings the page up to date: test_tutorial.py DIRECTORY
    PAGE.write_text(play(PAGE.read_text(encoding="utf-8"), sys.argv[1]), encoding="utf-8")
