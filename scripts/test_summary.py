#!/usr/bin/python3
"""Count the test results below a folder and name what failed; the last line is `N passed, N failed`."""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import List, NamedTuple


class Summary(NamedTuple):
    """Counts of test cases; `failures` holds one line per failed case or unreadable file."""

    passed: int
    skipped: int
    failures: List[str]


def summarise(folder: Path) -> Summary:
    """Read every JUnit file below `folder`: those of gtest, rostest and pytest."""
    passed = 0
    skipped = 0
    failures: List[str] = []
    for file in sorted(folder.rglob("*.xml")):
        try:
            root = ElementTree.parse(file).getroot()
        except ElementTree.ParseError as error:
            failures.append(f"{file.relative_to(folder)}: not a readable result ({error})")
            continue
        for case in root.iter("testcase"):
            name = f"{file.parent.name}: {case.get('classname', '')}.{case.get('name', '')}"
            problem = case.find("failure")
            if problem is None:
                problem = case.find("error")
            if problem is not None:
                text = (problem.get("message") or problem.text or "").strip()
                failures.append(f"{name}: {text.splitlines()[0] if text else 'failed'}")
            elif case.find("skipped") is not None or case.get("status") == "notrun":
                skipped += 1
            else:
                passed += 1
    return Summary(passed, skipped, failures)


def main() -> int:
    """Print the summary; 1 when a test failed or none ran."""
    if len(sys.argv) != 2:
        print("usage: test_summary.py RESULTS_FOLDER", file=sys.stderr)
        return 2
    summary = summarise(Path(sys.argv[1]))
    for failure in summary.failures:
        print(f"FAILED {failure}")
    if summary.skipped:
        print(f"{summary.skipped} skipped")
    print(f"{summary.passed} passed, {len(summary.failures)} failed")
    return 1 if summary.failures or summary.passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
