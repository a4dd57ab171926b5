#!/usr/bin/python3
"""Write a POMDP benchmark problem, built from its formula, as `.pomdp` or `.pomdpx`.

    generate_model.py rock_sample 7 8 --output RockSample_7_8.pomdpx
    generate_model.py room_search 16 > room.pomdp
"""

import argparse
import pathlib
import sys
from collections.abc import Callable

from benchmark_models import flat_file, network_file
from benchmark_models.maze import MAPS, four_by_three, maze
from benchmark_models.network import Network
from benchmark_models.rock_sample import rock_sample
from benchmark_models.room_search import room_search
from benchmark_models.tag import tag
from benchmark_models.tiger import tiger

WRITERS = {"pomdp": flat_file.write, "pomdpx": network_file.write}


def parse_args(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    problems = parser.add_subparsers(dest="problem", required=True, metavar="PROBLEM")

    def add(name: str, what: str, build: Callable[[argparse.Namespace], Network]):
        problem = problems.add_parser(name, help=what, description=what)
        problem.add_argument("--output", type=pathlib.Path, help="file to write; standard output")
        problem.add_argument(
            "--format", choices=sorted(WRITERS), help="default: by the file's name"
        )
        problem.set_defaults(build=build)
        return problem

    add("tiger", "two doors, a tiger behind one", lambda args: tiger())
    add("four_by_three", "Russell's maze of 4 x 3 cells", lambda args: four_by_three())
    rocks = add(
        "rock_sample",
        "a rover looks for good rocks: the published instance of the sizes, or a random one",
        lambda args: rock_sample(args.size, args.rocks, args.seed),
    )
    rocks.add_argument("size", type=int, help="the field has size x size cells")
    rocks.add_argument("rocks", type=int)
    rocks.add_argument("--seed", type=int, default=1, help="of the positions that nobody published")
    add("tag", "a robot hunts a target that flees", lambda args: tag())
    rooms = add(
        "room_search",
        "search of a room for an object that may be elsewhere",
        lambda args: room_search(args.cells),
    )
    rooms.add_argument("cells", type=int, help="a square number")
    mazes = add(
        "maze",
        "a robot with a heading in a noisy maze, from a published map or a file",
        lambda args: maze(args.name, read_map(args.name)),
    )
    mazes.add_argument("name", help=f"one of {', '.join(MAPS)}, or a text file with a map")
    return parser.parse_args(arguments)


def read_map(name: str) -> tuple[str, ...]:
    if name in MAPS:
        return MAPS[name]
    return tuple(pathlib.Path(name).read_text().rstrip("\n").split("\n"))


def main(arguments: list[str] | None = None) -> int:
    args = parse_args(arguments)
    ending = args.output.suffix[1:] if args.output else "pomdp"
    file_format = args.format or ending
    if file_format not in WRITERS:
        print(
            f"found a file name that ends in '.{ending}', expected .pomdp or .pomdpx",
            file=sys.stderr,
        )
        return 2
    try:
        network = args.build(args)
        if args.output:
            with open(args.output, "w", encoding="utf-8") as out:
                WRITERS[file_format](network, out)
        else:
            WRITERS[file_format](network, sys.stdout)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
