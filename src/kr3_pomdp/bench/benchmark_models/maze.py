"""Robots in mazes: one with a heading, noisy moves and noisy wall sensors (Hallway), one on Russell's 4 x 3 cells.

The first: actions are to stay, go forward, and turn right, about or left. Forward succeeds with 0.8,
fails with 0.05, and with 0.05 each the robot ends in the cell to its left or right, facing it, or in
the one behind it, facing either way along; a wall stops each of these. A turn is right with 0.7 (about:
0.6). A wall is seen with 0.9 where there is one and with 0.05 where there is none, on each of four
sides. In a goal cell the robot sees that, and starts again. Source: Littman, Cassandra and Kaelbling
(ICML 1995); parameters as in the published files.
"""

import itertools
from dataclasses import dataclass

from .network import Conditional, Network, Variable

GOAL, PENALTY, START, WALL = "+", "-", "s", " "
LANDMARKS = "abcdefgh"
HEADINGS = {"n": (0, -1), "e": (1, 0), "s": (0, 1), "w": (-1, 0)}
FORWARD, SLIP = 0.8, 0.05
SEES_WALL, IMAGINES_WALL = 0.9, 0.05
# Probability of turning by 0, 1, 2, 3 quarters to the right.
TURNS = {
    "stay": (1.0, 0.0, 0.0, 0.0),
    "right": (0.1, 0.7, 0.1, 0.1),
    "about": (0.1, 0.15, 0.6, 0.15),
    "left": (0.1, 0.1, 0.1, 0.7),
}
DISCOUNT = 0.95

MAPS = {
    "Hallway": ("**a*b*c*d**", "  * * * +"),
    "Hallway2": ("  *****", " ** * **", "  * * *", " ** * *+", "  *****"),
    "tiger-grid": ("-*+*-", "*s s*"),
}


@dataclass(frozen=True)
class Pose:
    x: int
    y: int
    heading: str

    def turned(self, quarters: int) -> "Pose":
        names = tuple(HEADINGS)
        return Pose(self.x, self.y, names[(names.index(self.heading) + quarters) % 4])

    def ahead(self) -> "Pose":
        dx, dy = HEADINGS[self.heading]
        return Pose(self.x + dx, self.y + dy, self.heading)

    @property
    def name(self) -> str:
        return f"x{self.x}y{self.y}{self.heading}"


def maze(name: str, rows: tuple[str, ...]) -> Network:
    """A maze from its map: one character a cell, row by row.

    ` ` wall, `*` cell, `+` goal (1 for being there, then the robot starts again), `-` a cell that
    costs 1 on arrival, `s` start facing north (without any, the robot starts at any pose that is no
    goal), `a` to `h` a cell in which the robot, when it faces south, sees a landmark of its own.

    @raises ValueError  another character, or no goal
    """
    cells = {
        (x, y): symbol
        for y, row in enumerate(rows)
        for x, symbol in enumerate(row)
        if symbol != WALL
    }
    for symbol in cells.values():
        if symbol not in f"*{GOAL}{PENALTY}{START}{LANDMARKS}":
            raise ValueError(f"found '{symbol}' in a map")
    if GOAL not in cells.values():
        raise ValueError("found a map without a goal")
    poses = {p.name: p for p in (Pose(x, y, h) for x, y in cells for h in HEADINGS)}
    landmarks = [symbol for symbol in LANDMARKS if symbol in cells.values()]

    def symbol_at(pose: Pose) -> str:
        return cells[pose.x, pose.y]

    def is_open(pose: Pose) -> bool:
        return (pose.x, pose.y) in cells

    starts = [p for p in poses.values() if symbol_at(p) == START and p.heading == "n"]
    starts = starts or [p for p in poses.values() if symbol_at(p) != GOAL]
    start = {p.name: 1.0 / len(starts) for p in starts}

    def gone(pose: Pose) -> dict[str, float]:
        behind = Pose(*_back(pose), pose.heading)
        reached = [
            (pose.ahead(), FORWARD),
            (pose.turned(1).ahead(), SLIP),
            (pose.turned(3).ahead(), SLIP),
            (behind, SLIP / 2.0),
            (behind.turned(2), SLIP / 2.0),
        ]
        result = {to.name: p for to, p in reached if is_open(to)}
        result[pose.name] = 1.0 - sum(result.values())
        return result

    def transition(action: str, variable: str) -> Conditional:
        del variable
        return Conditional(("pose",), lambda pose: followed(action, poses[pose]))

    def followed(action: str, pose: Pose) -> dict[str, float]:
        if symbol_at(pose) == GOAL:
            return start
        if action == "forward":
            return gone(pose)
        return {pose.turned(quarters).name: p for quarters, p in enumerate(TURNS[action])}

    def observation(action: str) -> Conditional:
        del action
        return Conditional(("pose",), lambda pose: seen(poses[pose]))

    def seen(pose: Pose) -> dict[str, float]:
        symbol = symbol_at(pose)
        if symbol == GOAL:
            return {"goal": 1.0}
        if symbol in LANDMARKS and pose.heading == "s":
            return {f"landmark_{symbol}": 1.0}
        walls = [not is_open(pose.turned(quarters).ahead()) for quarters in range(4)]
        return {name: _chance(walls, name) for name in wall_names}

    def reward(action: str) -> Conditional:
        return Conditional(("pose",), lambda pose: expected(followed(action, poses[pose])))

    def expected(following: dict[str, float]) -> float:
        worth = {GOAL: 1.0, PENALTY: -1.0}
        return sum(p * worth.get(symbol_at(poses[to]), 0.0) for to, p in following.items())

    wall_names = ["walls_" + "".join(bits) for bits in itertools.product("01", repeat=4)]
    return Network(
        name=name,
        description=f"Maze with noisy moves and wall sensors: {' / '.join(rows)}",
        discount=DISCOUNT,
        variables=(Variable("pose", tuple(poses)),),
        actions=("stay", "forward", "right", "about", "left"),
        observations=(*wall_names, *(f"landmark_{symbol}" for symbol in landmarks), "goal"),
        start={"pose": start},
        transition=transition,
        observation=observation,
        reward=reward,
    )


def _back(pose: Pose) -> tuple[int, int]:
    dx, dy = HEADINGS[pose.heading]
    return pose.x - dx, pose.y - dy


def _chance(walls: list[bool], name: str) -> float:
    """Probability of seeing the walls that the name tells: front, right, back, left."""
    product = 1.0
    for wall, bit in zip(walls, name.removeprefix("walls_")):
        sees = SEES_WALL if wall else IMAGINES_WALL
        product *= sees if bit == "1" else 1.0 - sees
    return product


def four_by_three() -> Network:
    """Russell's maze of 4 x 3 cells: moves slip to the sides, walls are seen to the left and right only.

    Source: Parr and Russell (IJCAI 1995); as published, the goal and the trap lead to a new start.
    """
    cells = [(x, y) for y in range(3) for x in range(4) if (x, y) != (1, 1)]
    names = {cell: f"x{cell[0]}y{cell[1]}" for cell in cells}
    by_name = {name: cell for cell, name in names.items()}
    goal, trap = names[3, 0], names[3, 1]
    free = [name for name in names.values() if name not in (goal, trap)]
    start = dict.fromkeys(free, 1.0 / len(free))

    def stepped(name: str, heading: str) -> str:
        (x, y), (dx, dy) = by_name[name], HEADINGS[heading]
        return names.get((x + dx, y + dy), name)

    def followed(action: str, name: str) -> dict[str, float]:
        if name in (goal, trap):
            return start
        sides = "ew" if action in "ns" else "ns"
        result: dict[str, float] = {}
        for heading, p in ((action, 0.8), (sides[0], 0.1), (sides[1], 0.1)):
            to = stepped(name, heading)
            result[to] = result.get(to, 0.0) + p
        return result

    def seen(name: str) -> dict[str, float]:
        if name in (goal, trap):
            return {"good" if name == goal else "bad": 1.0}
        left, right = stepped(name, "w") == name, stepped(name, "e") == name
        return {
            "both" if left and right else "left" if left else "right" if right else "neither": 1.0
        }

    return Network(
        name="4x3.95",
        description="Russell's maze of 4 x 3 cells",
        discount=DISCOUNT,
        variables=(Variable("cell", tuple(by_name)),),
        actions=("n", "s", "e", "w"),
        observations=("left", "right", "neither", "both", "good", "bad"),
        start={"cell": start},
        transition=lambda action, variable: Conditional(("cell",), lambda c: followed(action, c)),
        observation=lambda action: Conditional(("cell",), seen),
        reward=lambda action: Conditional(
            ("cell",), lambda c: 1.0 if c == goal else -1.0 if c == trap else -0.04
        ),
    )
