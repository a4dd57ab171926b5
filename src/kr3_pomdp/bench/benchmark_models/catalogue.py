"""The benchmark problems by name, with the sizes that were published."""

from collections.abc import Callable
from dataclasses import dataclass

from .maze import MAPS, four_by_three, maze
from .network import Network
from .rock_sample import rock_sample
from .room_search import room_search
from .tag import tag
from .tiger import tiger


@dataclass(frozen=True)
class Problem:
    """A problem that can be generated.

    file: its usual file name; the ending tells the format
    sizes: published numbers of (flat) states, actions and observations
    """

    file: str
    build: Callable[[], Network]
    sizes: tuple[int, int, int]


def _rooms(cells: int) -> Problem:
    sizes = (cells * (cells + 1) + 1, cells + 3, cells + 3)
    return Problem(f"RoomSearch_{cells}.pomdp", lambda: room_search(cells), sizes)


def _maze(name: str, sizes: tuple[int, int, int]) -> Problem:
    return Problem(f"{name}.pomdp", lambda: maze(name, MAPS[name]), sizes)


PROBLEMS = {
    problem.file: problem
    for problem in (
        Problem("Tiger.pomdp", tiger, (2, 3, 2)),
        Problem("4x3.95.pomdp", four_by_three, (11, 4, 6)),
        Problem("RockSample_4_4.pomdp", lambda: rock_sample(4, 4), (257, 9, 2)),
        _maze("tiger-grid", (36, 5, 17)),
        _maze("Hallway", (60, 5, 21)),
        _maze("Hallway2", (92, 5, 17)),
        Problem("TagAvoid.pomdp", tag, (870, 5, 30)),
        Problem("TagAvoid.pomdpx", tag, (870, 5, 30)),
        Problem("RockSample_5_5.pomdp", lambda: rock_sample(5, 5), (801, 10, 2)),
        Problem("RockSample_7_8.pomdpx", lambda: rock_sample(7, 8), (12800, 13, 2)),
        Problem("RockSample_11_11.pomdpx", lambda: rock_sample(11, 11), (249856, 16, 2)),
        *(_rooms(cells) for cells in (4, 9, 16, 25)),
    )
}
