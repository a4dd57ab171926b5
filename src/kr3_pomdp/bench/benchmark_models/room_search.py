"""Search of a room of n cells for an object that is in one of them or elsewhere: KR3's own family.

A move reaches its cell, or with a slip one of the cell's neighbours, and costs 1 and the distance; the
robot sees where it is after it. A look at the robot's cell costs 2 and is wrong at times. A grasp mostly
succeeds where the object is, and that ends the search; to finish is right where the object is elsewhere.
"""

import math

from .network import Conditional, Network, Variable, always

DISCOUNT = 0.98
SLIP, TRUE_POSITIVE, FALSE_POSITIVE, GRASPED = 0.05, 0.90, 0.05, 0.9
FETCHED, FAILED_GRASP, EMPTY_GRASP = 100.0, -4.0, -12.0
RIGHT_FINISH, WRONG_FINISH, LOOK = 20.0, -100.0, -2.0
ELSEWHERE, ENDED = "elsewhere", "ended"


def distance(width: int, a: int, b: int) -> int:
    """Steps between two cells, which are numbered row by row."""
    return abs(a % width - b % width) + abs(a // width - b // width)


def neighbours(width: int, cell: int) -> list[int]:
    return [other for other in range(width * width) if distance(width, cell, other) == 1]


def width_of(cells: int) -> int:
    """@raises ValueError  not a square of at least 4 cells"""
    width = math.isqrt(max(cells, 0))
    if cells < 4 or width * width != cells:
        raise ValueError(f"found {cells} cells, expected a square number of at least 4")
    return width


def room_search(cells: int) -> Network:
    """The robot starts in cell 0, the object is in any cell or elsewhere, all alike."""
    width = width_of(cells)
    robots = {f"r{i}": i for i in range(cells)}
    objects = {f"o{i}": i for i in range(cells)}
    places = (*objects, ELSEWHERE)
    moves = {f"move{i}": i for i in range(cells)}

    def arrived(goal: int) -> dict[str, float]:
        near = neighbours(width, goal)
        return {f"r{goal}": 1.0 - SLIP, **{f"r{cell}": SLIP / len(near) for cell in near}}

    def is_here(robot: str, target: str) -> bool:
        return robots[robot] == objects.get(target)

    def transition(action: str, variable: str) -> Conditional:
        if variable == "robot":
            if action not in moves:
                return Conditional(("robot",), lambda robot: {robot: 1.0})
            there = arrived(moves[action])
            return Conditional(
                ("robot", "object"),
                lambda robot, target: {robot: 1.0} if target == ENDED else there,
            )
        if action == "finish":
            return always({ENDED: 1.0})
        if action == "grasp":
            return Conditional(
                ("robot", "object"),
                lambda robot, target: {ENDED: GRASPED, target: 1.0 - GRASPED}
                if is_here(robot, target)
                else {target: 1.0},
            )
        return Conditional(("object",), lambda target: {target: 1.0})

    def observation(action: str) -> Conditional:
        return Conditional(("robot", "object"), lambda robot, target: seen(action, robot, target))

    def seen(action: str, robot: str, target: str) -> dict[str, float]:
        if action == "grasp":
            return {"yes" if target == ENDED else "no": 1.0}
        if target == ENDED or action == "finish":
            return {"none": 1.0}
        if action == "search":
            yes = TRUE_POSITIVE if is_here(robot, target) else FALSE_POSITIVE
            return {"yes": yes, "no": 1.0 - yes}
        return {f"at{robots[robot]}": 1.0}

    def reward(action: str) -> Conditional:
        return Conditional(("robot", "object"), lambda robot, target: earned(action, robot, target))

    def earned(action: str, robot: str, target: str) -> float:
        if target == ENDED:
            return 0.0
        if action in moves:
            return -1.0 - distance(width, robots[robot], moves[action])
        if action == "search":
            return LOOK
        if action == "finish":
            return RIGHT_FINISH if target == ELSEWHERE else WRONG_FINISH
        if is_here(robot, target):
            return GRASPED * FETCHED + (1.0 - GRASPED) * FAILED_GRASP
        return EMPTY_GRASP

    return Network(
        name=f"RoomSearch_{cells}",
        description=f"Search of a room of {cells} cells for an object that may be elsewhere",
        discount=DISCOUNT,
        variables=(
            Variable("robot", tuple(robots), seen=True),
            Variable("object", (*places, ENDED)),
        ),
        actions=(*moves, "search", "grasp", "finish"),
        observations=("none", "yes", "no", *(f"at{i}" for i in range(cells))),
        start={"robot": {"r0": 1.0}, "object": dict.fromkeys(places, 1.0 / len(places))},
        transition=transition,
        observation=observation,
        reward=reward,
        merged=lambda state: ENDED if state[1] == ENDED else "".join(state),
    )
