"""The Python module kr3_pomdp: solving, policies, simulation, threads and interruption."""

import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
from pomdp_examples import named, tiger_arrays

kr3 = pytest.importorskip("kr3_pomdp", reason="the workspace is not built or not sourced")

TIGER_VALUE = 19.37  # at the uniform belief, discount 0.95, to the digits that are published


def tiger():
    return kr3.modelFromArrays(*tiger_arrays(), discount=0.95, **named())


def hard_model():
    """Random and dense, so that solving takes long."""
    random = np.random.default_rng(3)
    transitions = random.dirichlet(np.ones(60), size=(4, 60))
    observations = random.dirichlet(np.ones(8), size=(4, 60))
    rewards = random.normal(size=(4, 60))
    return kr3.modelFromArrays(transitions, observations, rewards, discount=0.99)


def test_tiger_has_the_known_value():
    result = kr3.solve(tiger(), kr3.SolverLimits(precision=1e-4, max_backups=100000))
    assert result.reason == kr3.StopReason.kPrecision and str(result.reason) == "precision"
    assert result.lower <= TIGER_VALUE + 0.005 and result.upper >= TIGER_VALUE - 0.005
    assert result.upper - result.lower <= 1e-4
    assert result.policy.actionAt([0.5, 0.5]) == 0
    assert result.policy.valueAt(tiger().initial_belief) == result.lower


def test_the_exact_solution_lies_between_the_bounds():
    exact = kr3.solveExactly(tiger(), precision=1e-3)
    result = kr3.solve(tiger(), kr3.SolverLimits(precision=1e-3))
    assert result.lower <= exact.valueAt([0.5, 0.5]) + exact.error + 1e-9
    assert exact.valueAt([0.5, 0.5]) <= result.upper + 1e-9
    assert kr3.solveExactly(tiger(), horizon=1).valueAt([0.5, 0.5]) == pytest.approx(-1.0)
    assert len(kr3.solveExactly(tiger(), horizon=3).stages) == 3
    with pytest.raises(kr3.ResourceExhausted):
        kr3.solveExactly(tiger(), max_vectors=1)


def test_counted_work_repeats_exactly():
    limits = kr3.SolverLimits(precision=0.0, max_backups=300)
    first, second = (kr3.solve(hard_model(), limits) for _ in range(2))
    assert (first.lower, first.upper) == (second.lower, second.upper)
    assert first.reason == kr3.StopReason.kBackupLimit


def test_progress_is_told_and_can_cancel():
    told = []

    def listen(progress):
        if np.isfinite(progress.lower):  # not before the first bounds are there
            told.append((progress.lower, progress.upper))
        return len(told) < 5

    limits = kr3.SolverLimits(precision=0.0, time_s=30.0)
    result = kr3.solve(hard_model(), limits, listen, period_s=0.001)
    assert result.reason == kr3.StopReason.kCancelled
    lowers, uppers = np.transpose(told)
    assert (np.diff(lowers) >= 0).all() and (np.diff(uppers) <= 0).all()
    assert result.lower >= lowers[-1] - 1e-12


def test_what_a_listener_raises_ends_solving():
    def listen(_progress):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        kr3.solve(hard_model(), kr3.SolverLimits(time_s=30.0), listen)


def test_ctrl_c_ends_solving():
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    started = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        kr3.solve(hard_model(), kr3.SolverLimits(precision=0.0, time_s=30.0))
    assert time.monotonic() - started < 15.0


def test_other_threads_run_on_while_one_solves():
    limits = kr3.SolverLimits(precision=0.0, time_s=0.6)
    solver = threading.Thread(target=kr3.solve, args=(hard_model(), limits))
    solver.start()
    turns = 0
    while solver.is_alive():
        turns += 1
        time.sleep(0.005)
    assert turns > 10


def test_limits_out_of_range_are_refused():
    for limits in (
        kr3.SolverLimits(precision=0.0),
        kr3.SolverLimits(precision=-1.0),
        kr3.SolverLimits(time_s=float("nan")),
        kr3.SolverLimits(num_threads=0),
    ):
        with pytest.raises(kr3.InvalidArgument):
            kr3.solve(tiger(), limits)
    with pytest.raises(TypeError):
        kr3.solve(tiger(), 5)


def test_alpha_vectors_are_the_policy(tmp_path):
    policy = kr3.solve(tiger(), kr3.SolverLimits(max_backups=10000)).policy
    vectors = policy.alphaVectors()
    values = np.array([v.values for v in vectors if len(v.states) == 0])
    actions = np.array([v.action for v in vectors if len(v.states) == 0])
    left = np.linspace(0.0, 1.0, 21)
    beliefs = np.stack([left, 1.0 - left], axis=1)
    by_hand = (beliefs @ values.T).max(axis=1)
    chosen, earned = policy.bestAtEach(beliefs)
    assert np.allclose(earned, by_hand)
    assert set(chosen) <= set(actions)
    for belief, action, value in zip(beliefs, chosen, earned):
        best = policy.bestAt(belief)
        assert (best.action, best.value) == (action, value)
    path = str(tmp_path / "tiger.policy")
    policy.write(path)
    for again in (kr3.Policy.read(path), pickle.loads(pickle.dumps(policy)), rebuilt(policy)):
        assert np.array_equal(again.bestAtEach(beliefs)[1], earned)
    with pytest.raises(kr3.Unavailable):
        kr3.Policy.read(str(tmp_path / "none"))
    with pytest.raises(kr3.InvalidArgument, match="expected \\[n, 2\\]"):
        policy.bestAtEach(np.ones((4, 3)) / 3)


def rebuilt(policy):
    vectors = [
        kr3.AlphaVector(v.action, v.values, v.states if len(v.states) else None)
        for v in policy.alphaVectors()
    ]
    return kr3.Policy(policy.numStates(), vectors)


def test_the_simulated_value_lies_between_the_bounds():
    model = tiger()
    result = kr3.solve(model, kr3.SolverLimits(max_backups=10000))
    value = kr3.evaluate(model, result.policy, kr3.EvaluationLimits(trials=4000), seed=5)
    assert abs(value.mean - TIGER_VALUE) < 4 * value.standard_error
    limits = kr3.EvaluationLimits(trials=4000, num_threads=2)
    again = kr3.evaluate(model, result.policy, limits, seed=5)
    assert again.mean == value.mean


def test_simulating_by_hand_gives_the_models_frequencies():
    model = tiger()
    random = kr3.Random(4)
    heard = [kr3.sampleStep(model, "tiger_left", "listen", random).observation for _ in range(4000)]
    assert abs(np.mean(heard) - 0.15) < 4 * np.sqrt(0.15 * 0.85 / 4000)
    starts = [kr3.sampleState([0.2, 0.8], random) for _ in range(4000)]
    assert abs(np.mean(starts) - 0.8) < 4 * np.sqrt(0.2 * 0.8 / 4000)
    assert 0.0 <= random.uniform() < 1.0
    assert kr3.Random(7).uniform() == kr3.Random(7).uniform()
