"""The Python module kr3_pomdp: models from arrays, pieces, factors and files are one and the same."""

import pickle

import numpy as np
import pytest
from pomdp_examples import ACTIONS, HEARD, STATES, TIGER_FILE, named, tiger_arrays

kr3 = pytest.importorskip("kr3_pomdp", reason="the workspace is not built or not sourced")


def tiger():
    return kr3.modelFromArrays(*tiger_arrays(), discount=0.95, **named())


def same(a, b):
    assert np.array_equal(a.transitionArray(), b.transitionArray())
    assert np.array_equal(a.observationArray(), b.observationArray())
    assert np.array_equal(a.rewardArray(), b.rewardArray())
    assert np.array_equal(a.initial_belief, b.initial_belief)
    assert a.discount == b.discount
    assert (a.states, a.actions, a.observations) == (b.states, b.actions, b.observations)


def test_arrays_come_back_as_they_were_given():
    transitions, observations, rewards = tiger_arrays()
    model = tiger()
    assert np.array_equal(model.transitionArray(), transitions)
    assert np.array_equal(model.observationArray(), observations)
    assert np.array_equal(model.rewardArray(), rewards)
    assert (model.numStates(), model.numActions(), model.numObservations()) == (2, 3, 2)
    assert model.findAction("open_right") == 2 and model.findAction("sing") is None


def test_a_model_from_arrays_is_the_one_in_a_file(tmp_path):
    path = tmp_path / "tiger.pomdp"
    path.write_text(TIGER_FILE)
    same(kr3.loadModel(str(path)), tiger())


def test_files_hold_a_model_exactly(tmp_path):
    transitions, observations, rewards = tiger_arrays()
    observations[0] = [[1 / 3, 2 / 3], [0.1, 0.9]]
    model = kr3.modelFromArrays(transitions, observations, rewards, discount=0.95, **named())
    for name, write in (("m.pomdp", kr3.writePomdp), ("m.pomdpx", kr3.writePomdpx)):
        path = str(tmp_path / name)
        write(path, model)
        same(kr3.loadModel(path), model)


def test_sparse_arrays_are_pairs_or_dicts():
    transitions, observations, rewards = tiger_arrays()
    dense = tiger()
    pairs = kr3.modelFromArrays(
        dense.transitionEntries(),
        dense.observationEntries(),
        (np.argwhere(rewards), rewards[np.nonzero(rewards)]),
        discount=0.95,
        **named(),
    )
    same(pairs, dense)
    as_dict = kr3.modelFromArrays(
        dict(np.ndenumerate(transitions)),
        dict(np.ndenumerate(observations)),
        dict(np.ndenumerate(rewards)),
        discount=0.95,
        **named(),
    )
    same(as_dict, dense)
    halves = {(a, s, n): p / 2 for (a, s, n), p in np.ndenumerate(transitions)}
    indices = np.array(2 * list(halves))
    doubled = kr3.modelFromArrays(
        (indices, np.array(2 * list(halves.values()))),
        observations,
        rewards,
        discount=0.95,
        **named(),
    )
    same(doubled, dense)


def test_rewards_of_what_follows_are_averaged():
    transitions, observations, _ = tiger_arrays()
    full = np.random.default_rng(1).normal(size=(3, 2, 2, 2))
    expected = np.einsum("ast,ato,asto->as", transitions, observations, full)
    model = kr3.modelFromArrays(transitions, observations, full, discount=0.9)
    assert np.allclose(model.rewardArray(), expected, atol=1e-12)
    assert model.states == ["s0", "s1"] and model.observations == ["o0", "o1"]
    next_only = full[..., 0]
    model = kr3.modelFromArrays(transitions, observations, next_only, discount=0.9)
    assert np.allclose(model.rewardArray(), np.einsum("ast,ast->as", transitions, next_only))


def test_pieces_make_the_same_model():
    builder = kr3.ModelBuilder(STATES, ACTIONS, HEARD)
    builder.setDiscount(0.95)
    builder.setTransition(None, None, None, 0.5)
    builder.setObservation(None, None, None, 0.5)
    for s, state in enumerate(STATES):
        builder.setTransition("listen", state, None, 0.0)
        builder.setTransition("listen", state, state, 1.0)
        builder.setObservation(0, s, s, 0.85)
        builder.setObservation(0, s, 1 - s, 0.15)
        builder.setReward("listen", state, -1.0)
        builder.setReward(1 + s, s, -100.0, observation=None)
        builder.setReward(1 + s, 1 - s, 10.0)
    same(builder.build(), tiger())


def factored_tiger():
    role = kr3.VariableRole
    model = kr3.FactoredModel(
        state=[kr3.StateVariable("tiger", ["left", "right"])],
        actions=[kr3.Variable("do", ACTIONS)],
        observations=[kr3.Variable("hear", HEARD)],
        discount=0.95,
    )
    before, after = model.ref(role.kPrevious, "tiger"), model.ref(role.kCurrent, "tiger")
    action, heard = model.ref(role.kAction, "do"), model.ref(role.kObservation, "hear")
    transitions, observations, rewards = tiger_arrays()
    model.addInitial(kr3.Factor([], [before], np.array([0.5, 0.5])))
    model.addTransition(kr3.Factor([action, before], [after], transitions))
    model.addObserving(kr3.Factor([action, after], [heard], observations))
    model.addReward(kr3.Factor([action, before], [], rewards))
    return model


def test_factors_make_the_same_model():
    factored = factored_tiger()
    flat = factored.flattened()
    assert np.array_equal(flat.transitionArray(), tiger().transitionArray())
    assert np.array_equal(flat.observationArray(), tiger().observationArray())
    assert np.array_equal(flat.rewardArray(), tiger().rewardArray())
    assert factored.valuesOf(factored.transitions[0]).shape == (3, 2, 2)
    with pytest.raises(kr3.NotFound, match="lion"):
        factored.ref(kr3.VariableRole.kPrevious, "lion")
    factored.addReward(kr3.Factor([kr3.VariableRef(kr3.VariableRole.kAction, 0)], [], [1.0]))
    with pytest.raises(kr3.InvalidArgument):
        factored.flattened()


def test_errors_name_what_is_wrong(tmp_path):
    transitions, observations, rewards = tiger_arrays()
    transitions[1, 0] = [0.5, 0.4]
    with pytest.raises(
        kr3.InvalidArgument, match="state 'tiger_left', action 'open_left'"
    ) as error:
        kr3.modelFromArrays(transitions, observations, rewards, discount=0.95, **named())
    assert error.value.code == "INVALID_ARGUMENT" and isinstance(error.value, kr3.Error)
    transitions, observations, rewards = tiger_arrays()
    with pytest.raises(kr3.InvalidArgument, match=r"rewards: shape \[2, 3\], expected \[3, 2\]"):
        kr3.modelFromArrays(transitions, observations, rewards.T, discount=0.95, **named())
    with pytest.raises(kr3.InvalidArgument, match="index 7 of 2 in entry 0"):
        kr3.modelFromArrays({(0, 7, 0): 1.0}, observations, rewards, discount=0.95)
    with pytest.raises(kr3.InvalidArgument, match="how many observations"):
        kr3.modelFromArrays(transitions, {(0, 0, 0): 1.0}, rewards, discount=0.95)
    with pytest.raises(kr3.InvalidArgument, match="transitions: 'x': 1.0, expected a tuple"):
        kr3.modelFromArrays({"x": 1.0}, observations, rewards, discount=0.95)
    with pytest.raises(kr3.InvalidArgument, match="discount"):
        kr3.modelFromArrays(transitions, observations, rewards, discount=1.5)
    path = tmp_path / "bad.pomdp"
    path.write_text(TIGER_FILE.replace("0.85 0.15", "0.85 0.05"))
    with pytest.raises(kr3.InvalidArgument, match="bad.pomdp"):
        kr3.loadModel(str(path))
    with pytest.raises(kr3.Unavailable, match="nothing.pomdp"):
        kr3.loadModel(str(tmp_path / "nothing.pomdp"))


def test_a_belief_is_an_array_and_sums_to_one():
    model = tiger()
    belief = kr3.Belief([0.25, 0.75])
    assert np.array_equal(np.asarray(belief), [0.25, 0.75])
    assert len(belief) == 2 and belief[1] == 0.75
    assert pickle.loads(pickle.dumps(belief)) == belief
    with pytest.raises(ValueError, match="read-only"):
        np.asarray(belief)[0] = 1.0
    with pytest.raises(kr3.InvalidArgument):
        kr3.Belief([0.5, 0.4])
    with pytest.raises(IndexError):
        belief[2]  # pylint: disable=pointless-statement
    assert np.array_equal(model.withInitialBelief([0.25, 0.75]).initial_belief, belief)


def test_updating_a_belief_is_bayes_rule():
    model = tiger()
    transitions, observations, _ = tiger_arrays()
    prior = np.array([0.3, 0.7])
    for a, action in enumerate(ACTIONS):
        predicted = prior @ transitions[a]
        likelihood = kr3.observationProbabilities(model, prior, action)
        assert np.allclose(likelihood, predicted @ observations[a])
        for o, heard in enumerate(HEARD):
            update = kr3.updated(model, prior, action, heard)
            expected = predicted * observations[a, :, o]
            assert np.isclose(update.probability, expected.sum())
            assert np.allclose(update.posterior, expected / expected.sum())
    with pytest.raises(kr3.NotFound, match="'sing'"):
        kr3.updated(model, prior, "sing", 0)
    with pytest.raises(kr3.InvalidArgument, match="observation 5 of 2"):
        kr3.updated(model, prior, 0, 5)


def test_an_impossible_observation_is_an_error():
    transitions, observations, rewards = tiger_arrays()
    observations[0] = np.eye(2)
    model = kr3.modelFromArrays(transitions, observations, rewards, discount=0.95, **named())
    with pytest.raises(kr3.FailedPrecondition):
        kr3.updated(model, [1.0, 0.0], "listen", "hear_right")
