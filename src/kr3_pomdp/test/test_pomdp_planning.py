"""The Python module kr3_pomdp: planning online, on flat models and on models written in Python."""

from dataclasses import dataclass

import numpy as np
import pytest
from pomdp_examples import named, tiger_arrays

kr3 = pytest.importorskip("kr3_pomdp", reason="the workspace is not built or not sourced")

LISTEN, OPEN_LEFT, OPEN_RIGHT = range(3)


def counted(expansions, **options):
    return kr3.OnlineOptions(time_s=0.0, max_expansions=expansions, **options)


def tiger(discount=0.95):
    return kr3.modelFromArrays(*tiger_arrays(), discount=discount, **named())


class SampledTiger:
    """Tiger as a program; states are texts."""

    def numActions(self):
        return 3

    def discount(self):
        return 0.95

    def step(self, state, action, random):
        if action == LISTEN:
            wrong = random < 0.15
            heard = state if not wrong else {"left": "right", "right": "left"}[state]
            return state, heard, -1.0, False
        opened = "left" if action == OPEN_LEFT else "right"
        place = ("left", "right")[int(2 * random)]
        return place, "nothing", -100.0 if opened == state else 10.0, False

    def upperBound(self, state):
        return 10.0 / (1.0 - self.discount())


class FrankTiger(SampledTiger):
    def observationProbability(self, action, next_state, observation):
        if action == LISTEN:
            return 0.85 if observation == next_state else 0.15
        return float(observation == "nothing")


def test_a_flat_model_is_planned_by_sampling():
    planner = kr3.OnlinePlanner(tiger(), counted(50))
    assert planner.plan([0.5, 0.5]).action == LISTEN
    assert planner.plan([0.99, 0.01]).action == OPEN_RIGHT
    first, second = planner.plan([0.3, 0.7], seed=4), planner.plan([0.3, 0.7], seed=4)
    assert (first.lower, first.upper, first.num_nodes) == (
        second.lower,
        second.upper,
        second.num_nodes,
    )
    with pytest.raises(kr3.InvalidArgument, match="3 states, expected 2"):
        planner.plan([0.2, 0.3, 0.5])
    with pytest.raises(kr3.InvalidArgument):
        kr3.OnlinePlanner(tiger(), counted(0))


def test_exact_beliefs_are_searched_from_a_policy():
    model = tiger()
    policy = kr3.solve(model, kr3.SolverLimits(max_backups=5)).policy
    planner = kr3.BeliefPlanner(
        model, policy, kr3.BeliefPlannerOptions(time_s=0.0, max_expansions=2000)
    )
    decision = planner.plan()
    assert decision.action == LISTEN
    assert policy.valueAt([0.5, 0.5]) <= decision.lower <= 19.38 <= decision.upper + 0.01
    assert planner.advance(LISTEN, 0) == pytest.approx(0.5)
    assert np.allclose(planner.belief, [0.85, 0.15])
    planner.restart([0.98, 0.02])
    assert planner.plan().action == OPEN_RIGHT


@pytest.mark.parametrize("program", [SampledTiger, FrankTiger])
def test_a_model_written_in_python_is_played_well(program):
    model = program()
    random = kr3.Random(5)
    planner = kr3.GenerativePlanner(
        model,
        ["left", "right"],
        counted(12, num_scenarios=60, max_depth=8),
        kr3.ParticleOptions(num_particles=300),
        seed=2,
    )
    opened, eaten = 0, 0
    state = "left"
    for _ in range(60):
        decision = planner.plan()
        state, seen, reward, _ = model.step(state, decision.action, random.uniform())
        opened += decision.action != LISTEN
        eaten += reward < -50.0
        planner.advance(decision.action, seen)
    assert opened >= 8
    assert eaten <= 0.25 * opened  # guessing would be one half; hearing twice the same 3 %


@dataclass(frozen=True)
class Cell:
    row: int
    column: int


class Corridor:
    """Walk to the end; states are objects of a class, and the robot sees nothing."""

    def numActions(self):
        return 2

    def discount(self):
        return 0.9

    def step(self, state, action, random):
        column = state.column + (1 if action == 1 and random < 0.9 else 0)
        return Cell(0, column), None, 10.0 if column == 3 else -1.0, column == 3

    def upperBound(self, state):
        return 10.0


def test_states_are_any_objects():
    planner = kr3.GenerativePlanner(Corridor(), [Cell(0, 0)] * 10, counted(30, num_scenarios=50))
    assert planner.plan().action == 1
    planner.advance(1, None)
    assert set(planner.states) <= {Cell(0, 0), Cell(0, 1)}
    assert 0.8 < np.mean([s.column for s in planner.states]) < 1.0
    planner.restart([Cell(0, 2)])
    assert planner.plan().lower > 5.0


class Twin:
    """Two states that never change; the robot sees which."""

    def numActions(self):
        return 1

    def discount(self):
        return 0.5

    def step(self, state, action, random):
        return state, state, 0.0

    def upperBound(self, state):
        return 0.0


class ShyTwin(Twin):
    def perturbed(self, state, random):
        return 1 - state


def test_contradicting_all_samples_is_an_error_or_perturbs_them():
    planner = kr3.GenerativePlanner(Twin(), [0], counted(1))
    with pytest.raises(kr3.FailedPrecondition, match="no particle agrees"):
        planner.advance(0, 1)
    assert planner.states == [0]
    planner = kr3.GenerativePlanner(ShyTwin(), [0], counted(1))
    planner.advance(0, 1)
    assert set(planner.states) == {1}


def test_what_a_model_does_wrong_is_said():
    class Nothing:
        pass

    with pytest.raises(kr3.InvalidArgument, match="has no 'numActions'"):
        kr3.GenerativePlanner(Nothing(), [0], counted(1))

    class Short(Twin):
        def step(self, state, action, random):
            return state, 0

    with pytest.raises(kr3.InvalidArgument, match=r"step returned \(0, 0\), expected"):
        kr3.GenerativePlanner(Short(), [0], counted(1)).plan()

    class Raising(Twin):
        def upperBound(self, state):
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        kr3.GenerativePlanner(Raising(), [0], counted(1)).plan()

    class Interrupted(Twin):
        def upperBound(self, state):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        kr3.GenerativePlanner(Interrupted(), [0], counted(1)).plan()
    with pytest.raises(TypeError, match="unhashable"):
        kr3.GenerativePlanner(Twin(), [[1, 2]], counted(1))
    with pytest.raises(kr3.InvalidArgument, match="no particles"):
        kr3.GenerativePlanner(Twin(), [], counted(1))
