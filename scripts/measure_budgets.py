#!/usr/bin/python3
"""Measures what counted budgets of POMDP-1 are worth in CPU seconds on this machine, floor by floor, and prints the
table that the experiment `accuracy` takes its budgets from.

    source catkin_ws/devel/setup.bash
    scripts/measure_budgets.py --out src/kr3_experiments/config/budgets.yaml     # about half an hour
    scripts/measure_budgets.py --rooms 2,4 --seconds 1,10

Counts are rounded to two digits.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
from typing import Any, Dict, List

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
for package in ("kr3_common", "kr3_experiments"):
    sys.path.insert(0, str(ROOT / "src" / package / "python"))

from kr3_experiments.errors import Kr3Error  # noqa: E402
from kr3_experiments.experiment.report import machine  # noqa: E402
from kr3_experiments.experiment.sweep import commit  # noqa: E402
from kr3_experiments.experiment.worker import find_program  # noqa: E402

CELLS = 4  # a room


def rounded(count):
    """To two digits, at least 1."""
    return max(1, int(float(f"{count:.1e}")))


def measured(program, rooms, seconds, missions):
    """What kr3_budgets says of a floor."""
    with tempfile.TemporaryDirectory() as folder:
        make_floor = [sys.executable, str(ROOT / "scripts" / "make_floor.py"), folder]
        sizes = ["--rooms", str(rooms), "--cells", str(CELLS), "--defaults", "0"]
        subprocess.run(make_floor + sizes, check=True)
        options = ["--seconds", seconds, "--missions", str(missions)]
        done = subprocess.run([program, folder] + options, check=True, stdout=subprocess.PIPE)
    found = json.loads(done.stdout)
    return {
        "rooms": rooms,
        "cells": rooms * CELLS,
        "backups": [rounded(count) for count in found["backups"]],
        "prospects": [rounded(count) for count in found["prospects"]],
        "decisions": round(found["decisions"], 1),
        "most_used": rounded(found["most_used"]),
    }


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rooms", default="2,4,6,9,16,25,36,64,100", help="with commas")
    parser.add_argument("--seconds", default="1,10,100", help="of CPU, ascending, with commas")
    parser.add_argument("--missions", type=int, default=10, help="for the mean number of actions")
    parser.add_argument("--out", type=pathlib.Path, help="file (default: standard output)")
    args = parser.parse_args()
    try:
        program = find_program("kr3_executive", "kr3_budgets")
    except Kr3Error as error:
        sys.exit(str(error))
    floors: List[Dict[str, Any]] = []
    table = {
        "machine": machine(),
        "commit": commit(),
        "seconds": [float(seconds) for seconds in args.seconds.split(",")],
        "floors": floors,
    }
    for rooms in args.rooms.split(","):
        floors.append(measured(program, int(rooms), args.seconds, args.missions))
        print(floors[-1], file=sys.stderr)
    text = "# What counted budgets of POMDP-1 are worth, written by scripts/measure_budgets.py.\n"
    text += yaml.safe_dump(table, sort_keys=False, default_flow_style=None, width=120)
    if args.out:
        args.out.write_text(text, encoding="utf-8")
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
