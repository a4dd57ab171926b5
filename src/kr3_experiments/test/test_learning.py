"""The training phase without a robot: laws, trials in a simulated low level with known chances, counts, files."""
import json
import random
from dataclasses import replace
from pathlib import Path
from typing import Dict

import pytest
import yaml

from kr3_experiments.cli import main
from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.counts import (
    Attempt,
    AttemptLog,
    Durations,
    Observed,
    agree,
    count,
    effective_size,
    joined,
    read_attempts,
    share,
)
from kr3_experiments.learning.labels import attempts_from_labels
from kr3_experiments.learning.laws import GroundAction, LowLevel, State, Value
from kr3_experiments.learning.models_file import action_name, agreement, learned, outcomes_of
from kr3_experiments.learning.session import Lesson, conclude, load_lesson
from kr3_experiments.learning.trials import Curriculum, Outcome, train
from kr3_experiments.learning.truth import CellArea, Snapshot, Truth

OFFICE = repository_root() / "domains" / "office"
PLACES = ("office", "main_library", "aux_library", "kitchen", "study_corner", "corridor")
PARTS = {place: [f"{place}_c{i}" for i in range(2)] for place in PLACES}
SLIP, TRUE_POSITIVE, FALSE_POSITIVE, GRASP = 0.12, 0.85, 0.08, 0.7


@pytest.fixture(name="lesson")
def _lesson() -> Lesson:
    return load_lesson(OFFICE)


class SimulatedRobot:
    """Does what the office's laws say, with chances that are known."""

    def __init__(self, seed: int):
        self._random = random.Random(seed)
        cells = [cell for parts in PARTS.values() for cell in parts]
        self.state: Dict[str, Value] = {"loc(rob1)": cells[0]}
        for thing in ("tb1", "tb2", "tb3", "printer1", "printer2", "mug1", "mug2", "pot1"):
            self.state[f"loc({thing})"] = self._random.choice(cells)
            self.state[f"in_hand(rob1, {thing})"] = False

    def truth(self) -> Dict[str, Value]:
        return dict(self.state)

    def execute(self, action: GroundAction, state: State) -> Outcome:
        robot, *rest = action.arguments
        chance = self._random.random()
        if action.name == "move":
            neighbor = rest[0][:-1] + ("1" if rest[0].endswith("0") else "0")
            self.state[f"loc({robot})"] = neighbor if chance < SLIP else rest[0]
            for fluent, value in state.items():
                if fluent.startswith("in_hand") and value is True:
                    thing = fluent.partition(", ")[2].rstrip(")")
                    self.state[f"loc({thing})"] = self.state[f"loc({robot})"]
            seconds = 3.0 + 1.5 * 4.0 + self._random.gauss(0.0, 0.2)
            return Outcome("reached", (str(self.state[f"loc({robot})"]),), seconds, 4.0)
        if action.name == "search":
            so = state[f"loc({rest[1]})"] == rest[0]
            said = chance < (TRUE_POSITIVE if so else FALSE_POSITIVE)
            return Outcome("found" if said else "not_found", (), 6.0)
        if action.name == "grasp":
            self.state[f"in_hand({robot}, {rest[0]})"] = chance < GRASP
            return Outcome("succeeded" if chance < GRASP else "failed", (), 4.0)
        self.state[f"in_hand({robot}, {rest[0]})"] = False
        return Outcome("succeeded", (), 2.0)


A_WORLD = 40  # attempts


def run(lesson: Lesson, folder: Path, seed: int, wanted: int):
    """Counts of a whole training phase in the simulated low level."""
    laws = lesson.laws(PARTS)
    left = 1
    while left > 0:  # a world each time
        log = AttemptLog(folder / f"attempts{seed}.jsonl", {"seed": seed})
        drawn = 1000 * seed + len(log.attempts)
        curriculum = Curriculum(laws, lesson.bindings, lesson.entries, wanted, drawn)
        robot = SimulatedRobot(drawn)
        train(
            robot, curriculum, laws, lesson.entries, lesson.bindings, log, lambda _: None, A_WORLD
        )
        left = curriculum.left()
        log.close()
    return count(log.attempts, {name: laws.labels(name) for name in lesson.entries})


def estimates(counts):
    """The four unknowns."""
    moves, grasps = counts["move"].outcomes, counts["grasp"].outcomes
    sensor = counts["search"].sensors["loc"]
    return {
        "slip": share(moves["slipped"], sum(moves.values())),
        "grasp": share(grasps["succeeded"], sum(grasps.values())),
        "true": share(sensor.true_positive, sensor.true_positive + sensor.false_negative),
        "false": share(sensor.false_positive, sensor.false_positive + sensor.true_negative),
    }


def test_learned_values_come_to_the_known_ones_and_seeds_agree(lesson, tmp_path):
    known = {"slip": SLIP, "grasp": GRASP, "true": TRUE_POSITIVE, "false": FALSE_POSITIVE}
    runs = [estimates(run(lesson, tmp_path, seed, 60)) for seed in (1, 2)]
    outside = sum(
        not found[name].low <= value <= found[name].high
        for found in runs
        for name, value in known.items()
    )
    assert outside <= 2  # of 8 intervals of 95 %: more happens once in 170 draws of seeds
    for name, value in known.items():
        assert all(abs(found[name].mean - value) < 0.2 for found in runs)
        assert agree(runs[0][name], runs[1][name]), name


def test_more_trials_mean_narrower_intervals_around_the_truth(lesson, tmp_path):
    fews = [estimates(run(lesson, tmp_path, seed, 20)) for seed in (4, 14, 24)]
    many = estimates(run(lesson, tmp_path, 5, 120))
    for name, interval in many.items():
        wide = sum(few[name].high - few[name].low for few in fews) / len(fews)
        assert interval.high - interval.low < wide
    assert abs(many["true"].mean - TRUE_POSITIVE) < 0.12


def test_every_stratum_is_tried_as_often_as_wanted(lesson, tmp_path):
    counts = run(lesson, tmp_path, 6, 25)
    sensor = counts["search"].sensors["loc"]
    assert sensor.true_positive + sensor.false_negative >= 25
    assert sensor.false_positive + sensor.true_negative >= 25
    for name in ("move", "grasp", "putdown"):
        assert len(counts[name].durations.carried_out) >= 25


def clustered(generator: random.Random, visits: int, size: int):
    """Trials whose probability differs from visit to visit: 0.7 on the average."""
    chances = [generator.choice((0.4, 1.0)) for _ in range(visits)]
    return [(i, generator.random() < p) for i, p in enumerate(chances) for _ in range(size)]


def test_intervals_know_that_trials_of_a_visit_resemble_each_other():
    generator = random.Random(11)
    naive = robust = 0
    runs = 400
    for _ in range(runs):
        trials = clustered(generator, visits=12, size=8)
        hits = sum(hit for _, hit in trials)
        one = share(hits, len(trials))
        other = share(hits, len(trials), effective=effective_size(trials))
        assert one.mean == other.mean
        naive += one.low <= 0.7 <= one.high
        robust += other.low <= 0.7 <= other.high
    assert naive / runs < 0.80  # of 95 % stated
    assert robust / runs > 0.92


def test_independent_trials_count_in_full():
    assert effective_size([]) == 0.0
    assert effective_size([(None, True), (None, False)] * 10) == 20.0
    assert effective_size([(i, i % 3 == 0) for i in range(30)]) == 30.0
    alike = [(visit, visit < 5) for visit in range(10) for _ in range(6)]
    assert effective_size(alike) <= 10.0  # no more than there are visits
    assert effective_size([(1, True), (1, False)]) == 1.0


def test_two_estimates_agree_when_their_difference_may_be_zero():
    assert agree(share(8, 10), share(9, 10))
    assert not agree(share(90, 100), share(60, 100))
    # Overlapping intervals that differ nevertheless:
    first, second = share(80, 100), share(67, 100)
    assert first.low < second.high and not agree(first, second)


def test_training_phases_are_joined_and_compared(lesson, tmp_path, capsys):
    for seed in (21, 22):
        run(lesson, tmp_path, seed, 15)
    files = [tmp_path / f"attempts{seed}.jsonl" for seed in (21, 22)]
    first, second = (read_attempts(path) for path in files)
    both = joined([first, second])
    assert len(both) == len(first) + len(second)
    assert not {a.visit for a in both[: len(first)]} & {a.visit for a in both[len(first) :]}
    output = tmp_path / "models.yaml"
    arguments = ["learn", "office", "--attempts", *map(str, files), "--output", str(output)]
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "search: loc, yes where it is so" in out
    assert "of 6 numbers agree" in out
    assert f"From {len(both)} attempts ({len(first)}, {len(second)})" in output.read_text()
    changed = [replace(a, outcome="failed") if a.action == "grasp" else a for a in second]
    labels = {name: lesson.laws(PARTS).labels(name) for name in lesson.entries}
    _, apart = agreement(count(first, labels), count(changed, labels))
    assert apart == ["grasp: succeeded", "grasp: failed"]


def test_the_robot_asks_before_it_acts(lesson, tmp_path):
    """A grasp comes after a look that found the thing, in the same state: where it is, is known then."""
    run(lesson, tmp_path, 9, 25)
    attempts = read_attempts(tmp_path / "attempts9.jsonl")
    known = set()
    grasps = 0
    for before, attempt in zip([None, *attempts], attempts):
        if before is not None and before.action in ("move", "putdown"):
            known = set()
        if attempt.action == "search" and attempt.observed[0].said and attempt.observed[0].truth:
            known.add(attempt.arguments[2])
        if attempt.action == "grasp":
            grasps += attempt.arguments[1] in known
    assert grasps >= 0.9 * sum(attempt.action == "grasp" for attempt in attempts)


def test_what_the_robot_put_down_is_not_looked_for_in_the_same_world(lesson, tmp_path):
    run(lesson, tmp_path, 12, 40)
    handled, looks, stale = set(), 0, 0
    for number, attempt in enumerate(read_attempts(tmp_path / "attempts12.jsonl")):
        if number % A_WORLD == 0:
            handled = set()
        if attempt.action == "putdown":
            handled.add(attempt.arguments[1])
        elif attempt.action != "move":
            looks += 1
            stale += attempt.arguments[-1] in handled
    assert looks > 100
    assert stale == 0


def test_visits_are_numbered_through(lesson, tmp_path):
    run(lesson, tmp_path, 10, 20)
    attempts = read_attempts(tmp_path / "attempts10.jsonl")
    visits = [attempt.visit for attempt in attempts]
    assert visits == sorted(visits) and visits[0] == 1
    for number, (before, after) in enumerate(zip(attempts, attempts[1:]), 1):
        assert after.visit - before.visit in (0, 1)
        another_world = number % A_WORLD == 0
        assert before.action == "move" or another_world or after.visit == before.visit
    # A drive may slip back to where it began.
    moves = sum(attempt.action == "move" for attempt in attempts)
    assert visits[-1] > 0.8 * moves


def test_stated_intervals_hold_the_truth_as_often_as_they_say():
    generator = random.Random(7)
    for p in (0.05, 0.5, 0.9):
        hits = 0
        for _ in range(400):
            k = sum(generator.random() < p for _ in range(80))
            interval = share(k, 80)
            hits += interval.low <= p <= interval.high
        assert 0.90 <= hits / 400 <= 0.99


def test_laws_say_what_is_possible_and_what_happened(lesson):
    laws = lesson.laws(PARTS)
    state = {"loc(rob1)": "kitchen_c0", "loc(mug1)": "kitchen_c0", "loc(tb1)": "office_c1"}
    assert laws.possible(GroundAction("search", ("rob1", "kitchen_c0", "tb1")), state)
    assert not laws.possible(GroundAction("search", ("rob1", "kitchen_c1", "tb1")), state)
    assert laws.possible(GroundAction("grasp", ("rob1", "mug1")), state)
    assert not laws.possible(GroundAction("grasp", ("rob1", "tb1")), state)
    held = {**state, "in_hand(rob1, mug1)": True}
    assert not laws.possible(GroundAction("grasp", ("rob1", "mug1")), held)
    assert laws.possible(GroundAction("putdown", ("rob1", "mug1")), held)
    move = GroundAction("move", ("rob1", "office_c1"))
    assert laws.outcome(move, {"loc(rob1)": "office_c1"}) == "reached"
    assert laws.outcome(move, {"loc(rob1)": "office_c0"}) == "slipped"
    grasp = GroundAction("grasp", ("rob1", "mug1"))
    assert laws.outcome(grasp, held) == "succeeded"
    assert laws.outcome(grasp, state) == "failed"


def test_laws_of_another_domain_are_read_as_well():
    folder = repository_root() / "domains" / "workbench"
    laws = LowLevel(folder / "domain.kr3", folder / "refinement.kr3", {"psu": ["fuse", "coil"]})
    assert laws.labels("replace") == ["good_part", "dead_part"]
    probe = GroundAction("probe", ("tech1", "fuse", "hum"))
    assert probe in set(laws.ground_actions("probe"))
    assert not laws.possible(probe, {})
    assert laws.possible(probe, {"opened(fuse)": True})


def test_an_interrupted_log_goes_on_and_a_torn_line_is_dropped(tmp_path):
    path = tmp_path / "attempts.jsonl"
    attempt = Attempt("a", ("x",), True, "good", (Observed("f", True, False),), 1.5, 2.0)
    log = AttemptLog(path, {"seed": 1})
    log.add(attempt)
    log.close()
    with path.open("a") as file:
        file.write('{"action": "a", "argum')
    again = AttemptLog(path, {"seed": 1})
    assert again.attempts == [attempt] and again.dropped
    again.add(attempt)
    again.close()
    assert read_attempts(path) == [attempt, attempt]


def test_a_log_that_lacks_only_the_end_of_its_last_line_goes_on(tmp_path):
    path = tmp_path / "attempts.jsonl"
    attempt = Attempt("a", ("x",), True, "good", (Observed("f", True, False),), 1.5, 2.0)
    log = AttemptLog(path, {"seed": 1})
    log.add(attempt)
    log.close()
    path.write_bytes(path.read_bytes().rstrip(b"\n"))
    again = AttemptLog(path, {"seed": 1})
    again.add(attempt)
    again.close()
    assert read_attempts(path) == [attempt, attempt]


def test_bad_logs_are_named_with_their_line(tmp_path):
    path = tmp_path / "attempts.jsonl"
    AttemptLog(path, {"seed": 1}).close()
    with pytest.raises(Kr3Error, match="about"):
        AttemptLog(path, {"seed": 2})
    path.write_text('{"about": {"seed": 1}}\n{"action": "a"}\n')
    with pytest.raises(Kr3Error, match=r"attempts.jsonl:2: not an attempt"):
        AttemptLog(path, {"seed": 1})
    path.write_text('{"about": {"seed": 1}}\nnonsense\n{}\n')
    with pytest.raises(Kr3Error, match=r"attempts.jsonl:2: not JSON"):
        AttemptLog(path, {"seed": 1})
    path.write_text(
        '{"about": {"seed": 1}}\n'
        '{"action": "a", "arguments": [], "possible": true, "outcome": "", "observed": [], "duration_s": -1}\n'
    )
    with pytest.raises(Kr3Error, match="duration_s is -1"):
        read_attempts(path)
    with pytest.raises(Kr3Error, match="nowhere"):
        read_attempts(tmp_path / "nowhere.jsonl")


def test_durations_are_a_line_over_metres():
    exact = Durations([(float(x), 2.0 + 1.5 * x) for x in range(10)])
    base, slope, deviation = exact.line(True)
    assert (base, slope, deviation) == (
        pytest.approx(2.0),
        pytest.approx(1.5),
        pytest.approx(0.0, abs=1e-9),
    )
    base, slope, _ = Durations([(1.0, 1.0), (2.0, 3.0)]).line(True)
    assert base == 0.0 and slope > 0.0
    with pytest.raises(Kr3Error):
        Durations().line(False)


def test_the_models_file_says_what_was_learned_and_keeps_the_rest(lesson, tmp_path):
    laws = lesson.laws(PARTS)
    run(lesson, tmp_path, 8, 60)
    attempts = [a for a in read_attempts(tmp_path / "attempts8.jsonl") if a.action != "grasp"]
    output = tmp_path / "models.yaml"
    lines = conclude(lesson, laws, attempts, output, ["A test."], True)
    assert any("yes where it is not" in line for line in lines)
    models = yaml.safe_load(output.read_text())
    by_name = {action_name(key, output)[0]: entry for key, entry in models["actions"].items()}
    assert by_name["grasp"] == lesson.entries["grasp"]  # not tried
    move = by_name["move"]["outcomes"]
    assert sum(move["probabilities"].values()) == pytest.approx(1.0, abs=1e-9)
    assert move["source"] == "learned" and sum(move["counts"].values()) >= 60
    assert by_name["move"]["observations"] == lesson.entries["move"]["observations"]
    assert by_name["move"]["cost"]["distance"] == lesson.entries["move"]["cost"]["distance"]
    assert by_name["move"]["cost"]["counts"]["impossible"] == 0
    classes = {tuple(item["for"].items())[0] for item in by_name["search"]["classes"]}
    assert classes <= {("O", "textbook"), ("O", "printer"), ("O", "kitchenware")} and classes
    assert models["rewards"] == lesson.models["rewards"]


def test_outcomes_sum_to_one_whatever_the_counts():
    for counts in (
        {"a": 1, "b": 1, "c": 1},
        {"a": 0, "b": 7, "c": 0},
        {"a": 333, "b": 333, "c": 334},
    ):
        assert sum(outcomes_of(counts)["probabilities"].values()) == pytest.approx(1.0, abs=1e-12)


def test_nothing_learned_is_an_error_and_changes_nothing(lesson, tmp_path):
    with pytest.raises(Kr3Error, match="no attempts"):
        conclude(lesson, lesson.laws(PARTS), [], tmp_path / "models.yaml", [], False)
    assert not (tmp_path / "models.yaml").exists()
    assert learned(lesson.models, {}, OFFICE / "models.yaml")["actions"] == lesson.models["actions"]


def test_a_person_can_say_what_was_true(lesson, tmp_path):
    look = {"action": "search", "arguments": ["rob1", "office_c0", "tb1"], "duration_s": 7.0}
    lines = [
        {**look, "image": f"{i}.jpg", "outcome": o}
        for i, o in enumerate(("found", "not_found", "found"))
    ]
    (tmp_path / "looks.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    images = [
        {"image": "0.jpg", "objects": [{"name": "tb1", "box": [1, 2, 3, 4]}]},
        {"image": "1.jpg", "objects": [{"name": "tb1", "box": [1, 2, 3, 4]}]},
        {"image": "2.jpg", "objects": [{"name": "mug1", "box": [1, 2, 3, 4]}]},
    ]
    (tmp_path / "labels.json").write_text(json.dumps({"images": images}))
    sensor = count(attempts_from_labels(tmp_path, lesson), {})["search"].sensors["loc"]
    assert (sensor.true_positive, sensor.false_negative, sensor.false_positive) == (1, 1, 1)


@pytest.mark.parametrize(
    "labels, words",
    [
        ("{", "not JSON"),
        ("{}", "'images'"),
        ('{"images": [{"image": "0.jpg"}]}', "image 0"),
        (
            '{"images": [{"image": "0.jpg", "objects": [{"name": "x", "box": [1, 2, 0, 4]}]}]}',
            "no area",
        ),
        ('{"images": []}', "no entry for 0.jpg"),
    ],
)
def test_bad_labels_are_named(lesson, tmp_path, labels, words):
    look = {
        "image": "0.jpg",
        "action": "search",
        "arguments": ["rob1", "c", "tb1"],
        "outcome": "found",
        "duration_s": 1,
    }
    (tmp_path / "looks.jsonl").write_text(json.dumps(look) + "\n")
    (tmp_path / "labels.json").write_text(labels)
    with pytest.raises(Kr3Error, match=words):
        attempts_from_labels(tmp_path, lesson)


def test_the_offices_learned_models_are_what_its_training_tells(lesson, tmp_path):
    parts = [read_attempts(path) for path in sorted((OFFICE / "training").glob("*.jsonl"))]
    assert len(parts) == 2
    laws = lesson.laws({})
    conclude(lesson, laws, joined(parts), tmp_path / "m.yaml", [], False)
    stored = yaml.safe_load((OFFICE / "models_learned.yaml").read_text())
    assert yaml.safe_load((tmp_path / "m.yaml").read_text()) == stored
    labels = {name: laws.labels(name) for name in lesson.entries}
    lines, apart = agreement(count(parts[0], labels), count(parts[1], labels))
    assert len(lines) == 6 and not apart


def test_ground_truth_becomes_fluents():
    truth = Truth(OFFICE / "learning.yaml")
    cells = [CellArea("a", "x", (1.0, 1.0), (2.0, 2.0)), CellArea("b", "x", (3.0, 1.0), (2.0, 2.0))]
    state = truth.state(Snapshot({"rob1": (0.5, 1.0), "tb1": (3.9, 1.9)}, "tb1"), cells)
    assert state == {
        "loc(rob1)": "a",
        "loc(tb1)": "b",
        "in_hand(rob1, tb1)": True,
    }


@pytest.mark.parametrize(
    "text",
    [
        "robot: r",
        "robot: r\ntruth: {}",
        "robot: r\ntruth: {loc: {cell_of: X}}",
        "truth: [",
        "robot: r\ntruth: {loc(X): {inside: X}}",
    ],
)
def test_a_bad_learning_file_is_named(tmp_path, text):
    path = tmp_path / "learning.yaml"
    path.write_text(text)
    with pytest.raises(Kr3Error, match="learning.yaml"):
        Truth(path)
