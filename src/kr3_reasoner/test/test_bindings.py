"""The Python module kr3_reasoner: the library's names, its errors, threads, limits and cancellation."""

import inspect
import os
import signal
import threading
import time
from datetime import timedelta
from pathlib import Path

import pytest

kr3 = pytest.importorskip("kr3_reasoner", reason="the workspace is not built or not sourced")

LAMPS = str(Path(__file__).parent / "data/lamps.kr3")
COUNTER = str(Path(__file__).parent / "data/counter.kr3")
KNOWN = "init(on(left), false). init(on(right), false). init(shows(d) = 1, true)."


@pytest.fixture(name="reasoner")
def lamps():
    description = kr3.readDescription(LAMPS)
    reasoner = kr3.Reasoner(description)
    reasoner.setHistory(kr3.parseHistory(KNOWN, "known", description))
    return reasoner


def slow_reasoner():
    description = kr3.readDescription(COUNTER)
    reasoner = kr3.Reasoner(description)
    reasoner.setHistory(
        [kr3.Record(kr3.RecordKind.kInitially, f"on({bit})", value=False) for bit in range(14)]
    )
    return reasoner


def test_a_description_shows_its_names_and_prints_itself():
    description = kr3.readDescription(LAMPS)
    assert description.sorts["switch"] == ["left", "right"]
    assert {"wired", "on", "lit"} <= set(description.fluents)
    assert "break_down" in description.actions
    again = kr3.parseDescription(str(description), "again")
    assert str(again) == str(description)


def test_entailment_has_three_answers(reasoner):
    assert reasoner.entails("dark", 0) == kr3.Answer.kTrue
    assert reasoner.entails("lit(red)", 0) == kr3.Answer.kFalse
    empty = kr3.Reasoner(reasoner.description)
    assert empty.entails("on(left)", 0) == kr3.Answer.kUnknown
    assert empty.possibleValues("shows(d)", 0) == ["1", "2", "3"]
    assert "shows(d) = 1" in reasoner.entailedAt(0)


def test_records_grow_the_history_and_bad_ones_leave_it(reasoner):
    flip = kr3.Record(kr3.RecordKind.kHappened, "flip(left)")
    reasoner.addRecords([flip])
    assert (len(reasoner.history()), reasoner.currentStep()) == (4, 1)
    assert repr(reasoner.history()[3]) == "hpd(flip(left), 0)"
    with pytest.raises(kr3.InvalidArgument, match="middle"):
        reasoner.addRecords([flip, kr3.Record(kr3.RecordKind.kObserved, "on(middle)", step=1)])
    assert len(reasoner.history()) == 4


def test_a_surprise_is_diagnosed_and_explained(reasoner):
    reasoner.addRecords(
        [
            kr3.Record(kr3.RecordKind.kHappened, "flip(left)"),
            kr3.Record(kr3.RecordKind.kObserved, "lit(red)", value=False, step=1),
        ]
    )
    diagnosis = reasoner.diagnose()
    assert (diagnosis.consistent, diagnosis.cost) == (True, 1)
    assert diagnosis.explanations == [["init(broken(red), true)"]]
    (alternative,) = diagnosis.alternatives
    (assumption,) = alternative.assumptions
    assert assumption.kind == kr3.AssumptionKind.kException
    assert assumption.price == alternative.price == 1
    explanation = reasoner.explain("on(left)", 1)
    assert explanation.entailed and explanation.reasons and explanation.records
    (model,) = reasoner.models()
    assert model.actions == [["flip(left)"]]
    assert model.assumed == ["init(broken(red), true)"]


def test_prices_decide_between_explanations():
    description = kr3.readDescription(LAMPS)
    options = kr3.ReasonerOptions(diagnose_exogenous=True, default_weights={"sound": 3})
    reasoner = kr3.Reasoner(description, options)
    text = "init(on(left), true). init(on(right), false). obs(dark, true, 1)."
    reasoner.setHistory(kr3.parseHistory(text, "history", description))
    assert reasoner.diagnose().explanations == [["break_down(red) at 0"]]
    with pytest.raises(kr3.InvalidArgument, match="at least 1"):
        kr3.Reasoner(description, kr3.ReasonerOptions(exception_weight=0))


def test_what_if_leaves_the_history_alone(reasoner):
    supposed = reasoner.supposing([kr3.Record(kr3.RecordKind.kHappened, "flip(left)")])
    assert supposed.entails("lit(red)", 1) == kr3.Answer.kTrue
    assert len(reasoner.history()) == 3


def test_a_history_is_progressed(reasoner):
    reasoner.addRecords([kr3.Record(kr3.RecordKind.kHappened, "flip(left)")])
    progress = reasoner.progress(1)
    assert (progress.first_step, progress.num_records, progress.kept_because) == (1, 0, [])
    assert reasoner.firstStep() == reasoner.currentStep() == 1
    assert reasoner.entails("lit(red)", 1) == kr3.Answer.kTrue
    assert {model.first_step for model in reasoner.models()} == {1}
    with pytest.raises(kr3.InvalidArgument, match="the history begins at step 1"):
        reasoner.addRecords([kr3.Record(kr3.RecordKind.kObserved, "on(left)", step=0)])


def test_plans_and_no_plans_are_results(reasoner):
    horizons = []
    options = kr3.PlanOptions(max_horizon=4, on_horizon=horizons.append)
    (plan,) = reasoner.plan("lit(red) and lit(green)", options).plans
    assert sorted(action for step in plan.steps for action in step) == ["flip(left)", "flip(right)"]
    assert plan.hypothesis == []
    assert horizons == [1, 2]
    none = reasoner.plan("lit(red) and dark")
    assert none.plans == [] and none.reason
    assert reasoner.plan("dark").goal_entailed


def test_relevance_names_what_matters(reasoner):
    part = reasoner.relevant("lit(red)")
    assert "shows(d)" not in [item.name for item in part.fluents]
    assert part.considered.fluents < part.whole.fluents


def test_errors_are_of_one_family_with_codes(reasoner):
    with pytest.raises(kr3.NotFound, match="none.kr3") as error:
        kr3.readDescription("none.kr3")
    assert error.value.code == "NOT_FOUND"
    assert isinstance(error.value, kr3.Error) and isinstance(error.value, RuntimeError)
    with pytest.raises(kr3.InvalidArgument, match=r"bad:2:3: "):
        kr3.parseDescription("sorts\n  lamp = red.\n", "bad")
    with pytest.raises(kr3.InvalidArgument, match="step 9"):
        reasoner.entails("dark", 9)
    reasoner.addRecords([kr3.Record(kr3.RecordKind.kObserved, "on(left)", value=True)])
    with pytest.raises(kr3.FailedPrecondition, match="inconsistent"):
        reasoner.entails("dark", 0)
    assert reasoner.diagnose().consistent is False


@pytest.mark.parametrize("literal", ["on(\0)", "on(\x7f)", "on(\u00e4)", "(" * 2000, ""])
def test_odd_texts_are_refused(reasoner, literal):
    with pytest.raises(kr3.InvalidArgument):
        reasoner.entails(literal, 0)
    with pytest.raises(kr3.InvalidArgument):
        reasoner.plan(literal)


def test_a_time_limit_ends_planning():
    options = kr3.PlanOptions(max_horizon=1000, time_limit=timedelta(milliseconds=300))
    start = time.monotonic()
    with pytest.raises(kr3.DeadlineExceeded):
        slow_reasoner().plan("on(13)", options)
    assert time.monotonic() - start < 10.0


def test_planning_is_cancelled_from_another_thread_while_python_runs_on():
    cancellation = kr3.Cancellation()
    ticks = []

    def cancel_after_ticks():
        for _ in range(20):
            ticks.append(time.monotonic())
            time.sleep(0.01)
        cancellation.cancel()

    thread = threading.Thread(target=cancel_after_ticks)
    thread.start()
    options = kr3.PlanOptions(max_horizon=1000, time_limit=timedelta(seconds=60))
    with pytest.raises(kr3.Cancelled):
        slow_reasoner().plan("on(13)", options, cancellation)
    late = time.monotonic() - ticks[-1]
    thread.join()
    assert len(ticks) == 20
    assert late < 5.0


def test_threads_share_a_reasoner(reasoner):
    answers = []

    def ask():
        for _ in range(5):
            answers.append(reasoner.entails("dark", 0))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [kr3.Answer.kTrue] * 20


def test_a_program_for_plain_clingo_is_printed(reasoner):
    assert "#const _last = _now + 0." in reasoner.translation()
    assert "#const _last = _now + 1." in reasoner.translation("lit(red)", 1)


def members_of(item):
    return [(name, part) for name, part in vars(item).items() if not name.startswith("_")]


def test_everything_is_documented_in_words():
    for name, item in members_of(kr3):
        assert inspect.getdoc(item), name
        if not inspect.isclass(item) or hasattr(item, "__members__"):
            continue
        for part_name, part in members_of(item):
            lines = (inspect.getdoc(part) or "").splitlines()
            words = lines if isinstance(part, property) else [line for line in lines[1:] if line]
            assert words or isinstance(part, str), f"{name}.{part_name}"


def test_what_is_open_about_a_literal_is_told():
    description = kr3.readDescription(LAMPS)
    question = kr3.Reasoner(description).whyUnknown("on(left)", 0)
    assert question.open and question.values == ["false", "true"]
    assert question.deciding == ["on(left)"] and question.reasons


def test_literals_are_written_in_the_form_of_the_description():
    description = kr3.readDescription(str(Path(LAMPS).parent / "paper_predicates.kr3"))
    reasoner = kr3.Reasoner(description)
    text = "init(loc(rob1, office), true). obs(loc(tb1, main_library), false, 1)."
    reasoner.setHistory(kr3.parseHistory(text, "history", description))
    assert {"loc(rob1, office)", "loc(tb1, aux_library)"} <= set(reasoner.entailedAt(1))
    assert "loc(rob1, office)" in reasoner.models(1)[0].states[0]
    assert "loc(tb1, main_library) was not true" in reasoner.diagnose().in_words[0]


def test_messages_do_not_end_at_a_nul_byte(reasoner):
    with pytest.raises(kr3.InvalidArgument) as error:
        reasoner.entails("on(\0left)", 0)
    assert r"'on(\x00left)':1:4" in str(error.value)
    assert "found a NUL byte" in str(error.value) or "expected" in str(error.value)
    with pytest.raises(kr3.NotFound, match=r"a\\x00b"):
        kr3.readDescription("a\0b")
    with pytest.raises(kr3.InvalidArgument, match="expected"):
        reasoner.addRecords([kr3.Record(kr3.RecordKind.kObserved, "on(\0)")])


ENDLESS = """
sorts
  bit = 0..19.
fluents
  inertial on(bit).
actions
  flip(bit).
axioms
  flip(B) causes on(B) if -on(B).
  flip(B) causes -on(B) if on(B).
"""


def interrupted(ask):
    """Presses Ctrl-C while a question is answered."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # background jobs ignore it
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        ask()
    assert time.monotonic() - start < 5.0
    timer.join()
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_any_question_and_the_reasoner_goes_on():
    reasoner = kr3.Reasoner(kr3.parseDescription(ENDLESS, "endless"))
    interrupted(lambda: reasoner.models(0))
    assert reasoner.entails("on(3)", 0) == kr3.Answer.kUnknown
    counter = slow_reasoner()
    interrupted(lambda: counter.plan("on(13)", kr3.PlanOptions(max_horizon=1000)))
    assert counter.entails("on(13)", 0) == kr3.Answer.kFalse


def test_a_sparc_program_is_imported():
    imported = kr3.readSparc(str(Path(LAMPS).parent / "delivery.sp"))
    description = kr3.parseDescription(imported.description, "imported")
    assert kr3.parseHistory(imported.history, "imported", description)
    assert imported.goals == ["loc(mug, room1)"]
