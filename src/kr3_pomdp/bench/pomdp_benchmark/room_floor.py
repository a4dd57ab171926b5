"""Value of a greedy threshold rule for room search, as a floor that a solver must beat.

The rule keeps the exact belief. It grasps in the cell whose belief is above one threshold, finishes when
the belief in `elsewhere` is above another, and else looks into the cell that promises most belief for
the cost of going there and looking.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from benchmark_models import room_search as rooms

MAX_STEPS = 500
THRESHOLDS = (0.3, 0.5, 0.7, 0.8, 0.9, 0.95)


@dataclass(frozen=True)
class Floor:
    mean: float
    standard_error: float


class _Room:
    """Tables of a room, shape [cells, cells]: steps between cells, and neighbours."""

    def __init__(self, cells: int) -> None:
        width = rooms.width_of(cells)
        steps = [[rooms.distance(width, a, b) for b in range(cells)] for a in range(cells)]
        self.cells = cells
        self.steps = np.array(steps)
        near = [rooms.neighbours(width, cell) for cell in range(cells)]
        self.num_near = np.array([len(cells_near) for cells_near in near])
        self.near = np.array([[*cells_near, *[0] * (4 - len(cells_near))] for cells_near in near])


def greedy_floor(cells: int, trials: int, seed: int) -> Floor:
    """The best thresholds of a few, chosen on other trials, and their value."""
    room = _Room(cells)
    pairs = itertools.product(THRESHOLDS, THRESHOLDS)
    best = max(pairs, key=lambda pair: _simulate(room, *pair, 2000, seed + 1).mean())
    returns = _simulate(room, *best, trials, seed)
    return Floor(float(returns.mean()), float(returns.std() / np.sqrt(trials)))


def _simulate(room: _Room, sure: float, absent: float, trials: int, seed: int) -> np.ndarray:
    """Discounted returns of all trials side by side, shape [trials]."""
    rng = np.random.default_rng(seed)
    n = room.cells
    target = rng.integers(0, n + 1, trials)  # n is elsewhere
    robot = np.zeros(trials, dtype=int)
    belief = np.full((trials, n + 1), 1.0 / (n + 1))
    returns = np.zeros(trials)
    active = np.arange(trials)
    discount = 1.0
    for _ in range(MAX_STEPS):
        finishing = belief[active, n] > absent
        done = active[finishing]
        right = target[done] == n
        returns[done] += discount * np.where(right, rooms.RIGHT_FINISH, rooms.WRONG_FINISH)
        active = active[~finishing]
        if active.size == 0:
            break
        goal, confident = _choices(room, belief[active], robot[active], sure)
        away = goal != robot[active]
        _move(room, active[away], goal[away], robot, returns, discount, rng)
        here = ~away
        looked, grasped = active[here & ~confident], active[here & confident]
        _look(looked, target, robot, belief, returns, discount, rng)
        ended = _grasp(grasped, target, robot, belief, returns, discount, rng)
        active = active[~np.isin(active, ended)]
        discount *= rooms.DISCOUNT
    return returns


def _choices(
    room: _Room, belief: np.ndarray, robot: np.ndarray, sure: float
) -> tuple[np.ndarray, np.ndarray]:
    """The cell to go to, and whether to grasp there rather than look."""
    in_cells = belief[:, : room.cells]
    likeliest = in_cells.argmax(axis=1)
    confident = in_cells.max(axis=1) > sure
    steps = room.steps[robot]
    cost = -rooms.LOOK + np.where(steps > 0, 1.0 + steps, 0.0)
    return np.where(confident, likeliest, (in_cells / cost).argmax(axis=1)), confident


def _move(room, who, goal, robot, returns, discount, rng) -> None:
    returns[who] -= discount * (1.0 + room.steps[robot[who], goal])
    slips = rng.random(who.size) < rooms.SLIP
    pick = (rng.random(who.size) * room.num_near[goal]).astype(int)
    robot[who] = np.where(slips, room.near[goal, pick], goal)


def _look(who, target, robot, belief, returns, discount, rng) -> None:
    returns[who] += discount * rooms.LOOK
    chance = np.where(target[who] == robot[who], rooms.TRUE_POSITIVE, rooms.FALSE_POSITIVE)
    yes = rng.random(who.size) < chance
    elsewhere = np.where(yes, rooms.FALSE_POSITIVE, 1.0 - rooms.FALSE_POSITIVE)
    here = np.where(yes, rooms.TRUE_POSITIVE, 1.0 - rooms.TRUE_POSITIVE)
    _weigh(who, robot, belief, here, elsewhere)


def _grasp(who, target, robot, belief, returns, discount, rng) -> np.ndarray:
    """Those that fetched the object."""
    is_here = target[who] == robot[who]
    fetched = is_here & (rng.random(who.size) < rooms.GRASPED)
    missed = np.where(is_here, rooms.FAILED_GRASP, rooms.EMPTY_GRASP)
    returns[who] += discount * np.where(fetched, rooms.FETCHED, missed)
    _weigh(who, robot, belief, np.full(who.size, 1.0 - rooms.GRASPED), np.ones(who.size))
    return who[fetched]


def _weigh(who, robot, belief, here, elsewhere) -> None:
    """Bayes' rule: the likelihood in the robot's cell, and in all others."""
    likelihood = np.repeat(elsewhere[:, None], belief.shape[1], axis=1)
    likelihood[np.arange(who.size), robot[who]] = here
    posterior = belief[who] * likelihood
    belief[who] = posterior / posterior.sum(axis=1, keepdims=True)
