"""Tag: a robot hunts a target that flees, and sees it only in its own cell.

The robot moves as it likes. The target moves away from where the robot was: with probability 0.4
along the row, with 0.4 along the column (half each way where it is in line), else it stays; a wall
stops it, and it does not move while the robot tags in vain. Tagging earns 10 in the target's cell and
costs 10 elsewhere; a move costs 1. The robot sees its own cell, or after a move that the target is in
it. Once the target is tagged nothing moves.
Source: Pineau, Gordon and Thrun (IJCAI 2003).
"""

from .network import Conditional, Network, Variable, always

DISCOUNT = 0.95
FLEES_ALONG_ROW = FLEES_ALONG_COLUMN = 0.4
STEPS = {"north": (0, 1), "south": (0, -1), "east": (1, 0), "west": (-1, 0)}
TAGGED = "tagged"
Cell = tuple[int, int]

# Two long rows, and three short ones above them.
PUBLISHED_MAP = tuple((x, y) for y in range(5) for x in range(10) if y < 2 or 5 <= x <= 7)


def tag(cells: tuple[Cell, ...] = PUBLISHED_MAP) -> Network:
    """The published map by default."""
    if len(set(cells)) != len(cells) or len(cells) < 2:
        raise ValueError(f"found {len(cells)} cells, expected at least 2, none twice")
    robots = {f"r{i}": cell for i, cell in enumerate(cells)}
    targets = {f"t{i}": cell for i, cell in enumerate(cells)}
    numbers = {cell: i for i, cell in enumerate(cells)}

    def stepped(cell: Cell, step: tuple[int, int]) -> int:
        """Number of the cell that a step leads to; a wall stops it."""
        return numbers.get((cell[0] + step[0], cell[1] + step[1]), numbers[cell])

    def moved(action: str, robot: str, target: str) -> str:
        """Where the robot is after an action; with the target tagged it stays."""
        if target == TAGGED or action not in STEPS:
            return robot
        return f"r{stepped(robots[robot], STEPS[action])}"

    def fled(robot: Cell, target: Cell) -> dict[str, float]:
        result = {f"t{numbers[target]}": 1.0 - FLEES_ALONG_ROW - FLEES_ALONG_COLUMN}
        for axis, share in ((0, FLEES_ALONG_ROW), (1, FLEES_ALONG_COLUMN)):
            apart = target[axis] - robot[axis]
            signs = (1, -1) if apart == 0 else (1,) if apart > 0 else (-1,)
            for sign in signs:
                name = f"t{stepped(target, (sign, 0) if axis == 0 else (0, sign))}"
                result[name] = result.get(name, 0.0) + share / len(signs)
        return result

    def transition(action: str, variable: str) -> Conditional:
        if variable == "robot":
            return Conditional(
                ("robot", "target"), lambda robot, target: {moved(action, robot, target): 1.0}
            )

        def followed(robot: str, target: str) -> dict[str, float]:
            if target == TAGGED or action == "tag":
                caught = robots[robot] == targets.get(target)
                return {TAGGED if caught else target: 1.0}
            return fled(robots[robot], targets[target])

        return Conditional(("robot", "target"), followed)

    def observation(action: str) -> Conditional:
        if action == "tag":
            return Conditional(("robot",), lambda robot: {f"at_{robot}": 1.0})
        return Conditional(
            ("robot", "target"),
            lambda robot, target: {
                "here" if robots[robot] == targets.get(target) else f"at_{robot}": 1.0
            },
        )

    def reward(action: str) -> Conditional:
        if action != "tag":
            return always(-1.0)
        return Conditional(
            ("robot", "target"),
            lambda robot, target: 0.0
            if target == TAGGED
            else 10.0
            if robots[robot] == targets[target]
            else -10.0,
        )

    uniform = 1.0 / len(cells)
    return Network(
        name="TagAvoid",
        description=f"Tag on {len(cells)} cells",
        discount=DISCOUNT,
        variables=(
            Variable("robot", tuple(robots), seen=True),
            Variable("target", (*targets, TAGGED)),
        ),
        actions=(*STEPS, "tag"),
        observations=(*(f"at_{robot}" for robot in robots), "here"),
        start={
            "robot": dict.fromkeys(robots, uniform),
            "target": dict.fromkeys(targets, uniform),
        },
        transition=transition,
        observation=observation,
        reward=reward,
    )
