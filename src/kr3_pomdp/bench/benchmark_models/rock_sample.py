"""RockSample(n, k): a rover on n x n cells looks for good rocks among k, from afar, and takes samples of them.

The rover knows where it is. A check of rock i tells good from bad with probability
(1 + 2^(-d / d0)) / 2 at distance d; a sample earns 10 if the rock is good, which makes it bad, and
costs 10 if it is bad. Leaving at the east side earns 10 and ends. Leaving elsewhere, or sampling
where no rock is, costs 100 and ends, as in the published instances.
Source: Smith and Simmons (UAI 2004), section 5.
"""

import math
import random
from dataclasses import dataclass

from .network import Conditional, Network, Variable, always

Cell = tuple[int, int]

DISCOUNT = 0.95
GOOD_SAMPLE, BAD_SAMPLE, EXIT, MISTAKE = 10.0, -10.0, 10.0, -100.0
STEPS = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}
OUT = "out"


@dataclass(frozen=True)
class Field:
    """An instance: cells are (x, y), y grows to the north.

    half_distance: d0, the distance at which what a check tells has halved
    """

    size: int
    start: Cell
    rocks: tuple[Cell, ...]
    half_distance: float = 20.0

    def __post_init__(self) -> None:
        if self.size < 1 or self.half_distance <= 0.0:
            raise ValueError(
                f"found size {self.size} and half distance {self.half_distance}, expected positive"
            )
        if not self.rocks or len(set(self.rocks)) != len(self.rocks):
            raise ValueError(f"found rocks {self.rocks}, expected at least one, none twice")
        for x, y in (self.start, *self.rocks):
            if not (0 <= x < self.size and 0 <= y < self.size):
                raise ValueError(
                    f"found cell ({x}, {y}) outside of {self.size} x {self.size} cells"
                )


# Rocks and half distances of the published instances.
PUBLISHED = {
    (4, 4): Field(4, (0, 2), ((3, 1), (2, 1), (1, 3), (1, 0)), math.log(2.0)),
    (5, 5): Field(5, (0, 2), ((2, 4), (0, 4), (3, 3), (2, 2), (4, 1)), 4.0),
    (7, 8): Field(7, (0, 3), ((2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6))),
    (11, 11): Field(
        11,
        (0, 5),
        ((0, 3), (0, 7), (1, 8), (2, 4), (3, 3), (3, 8), (4, 3), (5, 8), (6, 1), (9, 3), (9, 9)),
    ),
}


def random_field(size: int, rocks: int, seed: int) -> Field:
    """Rocks anywhere but at the start, which is the middle of the west side."""
    start = (0, size // 2)
    cells = [(x, y) for x in range(size) for y in range(size) if (x, y) != start]
    if not 1 <= rocks <= len(cells):
        raise ValueError(f"found {rocks} rocks, expected 1 to {len(cells)}")
    return Field(size, start, tuple(random.Random(seed).sample(cells, rocks)))


def rock_sample(size: int, rocks: int, seed: int = 1) -> Network:
    """The published instance of these sizes, or one drawn with the seed."""
    return network(PUBLISHED.get((size, rocks)) or random_field(size, rocks, seed))


def accuracy(field: Field, cell: Cell, rock: Cell) -> float:
    """Probability that a check from `cell` tells what `rock` is."""
    return 0.5 * (1.0 + 2.0 ** (-math.dist(cell, rock) / field.half_distance))


def network(field: Field) -> Network:
    cells = {f"x{x}y{y}": (x, y) for x in range(field.size) for y in range(field.size)}
    names = {cell: name for name, cell in cells.items()}
    rocks = {f"rock{i}": cell for i, cell in enumerate(field.rocks)}
    checks = {f"check{i}": f"rock{i}" for i in range(len(rocks))}

    def moved(action: str, robot: str) -> str:
        """Where the rover is after an action."""
        if robot == OUT or action in checks:
            return robot
        if action == "sample":
            return robot if cells[robot] in rocks.values() else OUT
        (x, y), (dx, dy) = cells[robot], STEPS[action]
        return names.get((x + dx, y + dy), OUT)

    def transition(action: str, variable: str) -> Conditional:
        if variable == "robot":
            return Conditional(("robot",), lambda robot: {moved(action, robot): 1.0})
        if action != "sample":
            return Conditional((variable,), lambda rock: {rock: 1.0})
        where = names[rocks[variable]]
        return Conditional(
            ("robot", variable), lambda robot, rock: {"bad" if robot == where else rock: 1.0}
        )

    def observation(action: str) -> Conditional:
        if action not in checks:
            return always({"good": 1.0})
        rock = checks[action]

        def told(robot: str, quality: str) -> dict[str, float]:
            if robot == OUT:
                return {"good": 1.0}
            right = accuracy(field, cells[robot], rocks[rock])
            return {
                "good": right if quality == "good" else 1.0 - right,
                "bad": right if quality == "bad" else 1.0 - right,
            }

        return Conditional(("robot", rock), told)

    def reward(action: str) -> Conditional:
        if action in checks:
            return always(0.0)
        if action == "sample":
            return Conditional(("robot", *rocks), sampled)
        return Conditional(("robot",), lambda robot: left(action, robot))

    def left(action: str, robot: str) -> float:
        if robot == OUT or moved(action, robot) != OUT:
            return 0.0
        return EXIT if action == "east" else MISTAKE

    def sampled(robot: str, *qualities: str) -> float:
        for cell, quality in zip(rocks.values(), qualities):
            if names[cell] == robot:
                return GOOD_SAMPLE if quality == "good" else BAD_SAMPLE
        return 0.0 if robot == OUT else MISTAKE

    half = {"bad": 0.5, "good": 0.5}
    return Network(
        name=f"RockSample_{field.size}_{len(rocks)}",
        description=f"RockSample: {field.size} x {field.size} cells, start {field.start}, "
        f"rocks {field.rocks}, half distance {field.half_distance:g}",
        discount=DISCOUNT,
        variables=(
            Variable("robot", (*cells, OUT), seen=True),
            *(Variable(rock, ("bad", "good")) for rock in rocks),
        ),
        actions=(*STEPS, *checks, "sample"),
        observations=("good", "bad"),
        start={"robot": {names[field.start]: 1.0}, **{rock: half for rock in rocks}},
        transition=transition,
        observation=observation,
        reward=reward,
        merged=lambda state: OUT if state[0] == OUT else "_".join(state),
    )
