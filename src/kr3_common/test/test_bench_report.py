"""Benchmarks say of which commit their figures are."""
import json
import subprocess
from pathlib import Path

from kr3_common.bench_report import commit, write_report


def git(folder: Path, *arguments: str) -> str:
    identity = ["-c", "user.name=test", "-c", "user.email=test@example.org"]
    command = ["git", "-C", str(folder), *identity, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def test_the_commit_is_the_checkouts_and_says_when_files_differ(tmp_path: Path) -> None:
    assert commit(tmp_path) == "unknown"
    git(tmp_path, "init")
    (tmp_path / "file").write_text("one", encoding="utf-8")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "-m", "one")
    head = git(tmp_path, "rev-parse", "HEAD")
    assert head.startswith(commit(tmp_path)) and len(commit(tmp_path)) >= 12
    (tmp_path / "file").write_text("two", encoding="utf-8")
    assert commit(tmp_path) == head[:12] + "+"


def test_the_file_holds_all_rows_and_where_they_were_measured(tmp_path: Path) -> None:
    rows = [{"name": "speed", "value": 2.5}, {"name": "size", "value": 3}]
    write_report(tmp_path / "out.json", "some", tmp_path, iter(rows), options={"seed": 1})
    found = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert found["rows"] == rows
    assert found["bench"] == "some" and found["options"] == {"seed": 1}
    assert found["commit"] == "unknown" and "cores" in found["machine"]
