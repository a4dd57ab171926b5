"""The file that every benchmark of KR3 writes: what was measured, of which commit, and where."""
import json
import os
import platform
import subprocess
from pathlib import Path
from typing import Any, Iterable, Mapping


def commit(folder: Path) -> str:
    """The commit of the checkout that holds `folder`, with "+" when files differ from it; "unknown" outside of one."""

    def git(*arguments: str) -> "str | None":
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else None

    head = git("rev-parse", "--short=12", "HEAD")
    if head is None:
        return "unknown"
    return head + ("+" if git("status", "--porcelain", "--untracked-files=no") else "")


def write_report(
    file: Path, bench: str, folder: Path, rows: Iterable[Mapping[str, Any]], **more: Any
) -> None:
    """Write the rows of a benchmark as JSON.

    @param bench  its name. @param folder  anywhere in the checkout that was measured. @param rows  each with `name`,
    `value`, `unit`, `goal`, `better` and `params`. @param more  entries beside `rows`. @throws OSError
    """
    content = {
        "bench": bench,
        "commit": commit(folder),
        "machine": f"{platform.node()} {platform.machine()} {os.cpu_count()} cores",
        **more,
        "rows": list(rows),
    }
    file.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
