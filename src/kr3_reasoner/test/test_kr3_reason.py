"""The command-line tool kr3_reason: its answers, its errors with their places, its exit codes."""

import json
import math
from pathlib import Path

import pytest
from reason_tool import run

DATA = Path(__file__).parent / "data"
LAMPS = str(DATA / "lamps.kr3")
KNOWN = "init(on(left), false).\ninit(on(right), false).\ninit(shows(d) = 1, true).\n"


def answer(*arguments):
    """The JSON answer of a question that has one."""
    result = run(*arguments, "--format", "json")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.fixture(name="history")
def history_file(tmp_path):
    file = tmp_path / "known.hist"
    file.write_text(KNOWN, encoding="utf-8")
    return str(file)


def test_check_counts_and_names_every_error_with_its_place(tmp_path):
    reply = answer("check", LAMPS)
    assert reply["command"] == "check"
    assert (reply["sorts"], reply["fluents"], reply["actions"], reply["defaults"]) == (4, 5, 4, 1)
    wrong = tmp_path / "wrong.kr3"
    wrong.write_text("sorts\n  lamp = {red}.\nfluents\n  inertial on(lump).\n  inertal off.\n")
    result = run("check", wrong)
    assert result.returncode == 1
    assert f"{wrong}:4:" in result.stderr and "lump" in result.stderr
    assert f"{wrong}:5:3: " in result.stderr


def test_one_description_may_stand_in_several_files(tmp_path):
    objects = tmp_path / "objects.kr3"
    objects.write_text("sorts\n  lamp = {red}.\n")
    domain = tmp_path / "domain.kr3"
    domain.write_text("fluents\n  inertial on(lamp).\n")
    assert answer("check", domain, objects)["files"] == [str(domain), str(objects)]
    assert run("check", domain).returncode == 1


def test_entails_answers_one_literal_or_tells_all(history):
    reply = answer("entails", LAMPS, "--history", history, "--literal", "dark")
    assert (reply["answer"], reply["possible"], reply["step"]) == ("true", True, 0)
    every = answer("entails", LAMPS, "--history", history)
    assert {"dark", "-on(left)", "shows(d) = 1"} <= set(every["literals"])
    text = run("entails", LAMPS, "--literal", "on(left)").stdout
    assert text == "on(left) at step 0: unknown (possible, not certain)\n"


def test_what_if_questions_assume_more_records(history):
    ask = ("entails", LAMPS, "--history", history, "--literal", "lit(red)")
    assert answer(*ask)["answer"] == "false"
    assert answer(*ask, "--assume", "hpd(flip(left), 0)")["answer"] == "true"
    assert answer(*ask)["answer"] == "false"


def test_explain_cites_records_with_their_lines(history):
    reply = answer("explain", LAMPS, "--history", history, "--literal", "-on(right)")
    assert reply["answer"] == "true" and reply["reasons"]
    assert reply["records"] == [
        {"record": "init(on(right), false)", "file": history, "line": 2, "index": 1}
    ]
    assert reply["defaults"] == [] and reply["laws"] == []
    leaves = [reply["proof"]]
    while leaves[0]["children"]:
        leaves = leaves[0]["children"]
    assert [leaf["record"] for leaf in leaves] == [1]
    assert leaves[0]["kind"] == "observed" and leaves[0]["source"]["line"] == 2


def test_models_are_listed_up_to_a_limit(history):
    reply = answer("models", LAMPS, "--limit", "5")
    assert len(reply["models"]) == 5 and reply["complete"] is False
    assert len(answer("models", LAMPS, "--all")["models"]) == 12
    (only,) = answer("models", LAMPS, "--history", history, "--assume", "hpd(flip(left), 0)")[
        "models"
    ]
    assert only["actions"] == [["flip(left)"]]
    before, after = map(set, only["states"])
    assert {"dark", "-on(left)", "-lit(red)", "shows(d) = 1"} <= before
    assert {"-dark", "on(left)", "lit(red)", "shows(d) = 1"} <= after
    exogenous = answer(
        "models", LAMPS, "--history", history, "--assume", "obs(broken(red), true, 1)"
    )
    assert exogenous["models"][0]["assumed"] == ["init(broken(red), true)"]


def test_a_history_may_begin_at_a_later_step(history, tmp_path):
    day = tmp_path / "day.hist"
    day.write_text(KNOWN + "hpd(flip(left), 0).\nhpd(flip(right), 1).\n", encoding="utf-8")
    late = ("--history", str(day), "--progress", "1")
    (model,) = answer("models", LAMPS, *late)["models"]
    assert (model["first_step"], len(model["states"])) == (1, 2)
    assert (
        answer("entails", LAMPS, *late, "--literal", "lit(red)", "--step", "2")["answer"] == "true"
    )
    assert run("entails", LAMPS, *late, "--literal", "lit(red)", "--step", "0").returncode == 1
    assert answer("plan", LAMPS, *late, "--goal", "dark")["plans"][0]["steps"]


def test_diagnose_prices_what_it_assumes(history):
    ask = ("diagnose", LAMPS, "--history", history, "--assume", "hpd(flip(left), 0)")
    dark = ("--assume", "obs(lit(red), false, 1)")
    assert answer(*ask)["cost"] == 0
    reply = answer(*ask, *dark)
    assert reply["cost"] == 1
    assert [e["statements"] for e in reply["explanations"]] == [["init(broken(red), true)"]]
    (assumption,) = reply["explanations"][0]["assumptions"]
    assert assumption["price"] == 1 and assumption["defaults"] == ["sound(red)"]
    both = answer(*ask, *dark, "--exogenous")
    assert len(both["explanations"]) == 2
    dear = answer(*ask, *dark, "--exogenous", "--default-weight", "sound=5")
    assert [e["statements"] for e in dear["explanations"]] == [["break_down(red) at 0"]]
    assert answer(*ask, *dark, "--exogenous-weight", "3", "--exception-weight", "2")["cost"] == 2


CLOCKS = """
sorts
  clock = {hall, attic}.
fluents
  inertial runs(clock).
actions
  exogenous stop(clock).
  wind(clock).
axioms
  stop(C) causes -runs(C).
  wind(C) causes runs(C).
  impossible stop(C) if -runs(C).
defaults
  wound(C): runs(C) if clock(C).
"""


def test_diagnose_tells_parts_that_do_not_hang_together(tmp_path):
    domain = tmp_path / "clocks.kr3"
    domain.write_text(CLOCKS)
    ask = ("diagnose", domain, "--exogenous", "--assume", "obs(runs(hall), false, 2)")
    ask += ("--assume", "obs(runs(attic), false, 1)")
    reply = answer(*ask)
    parts = reply["parts"]
    assert sorted(len(part["explanations"]) for part in parts) == [2, 3]
    assert [part["price"] for part in parts] == [1, 1] and reply["cost"] == 2
    assert len(reply["explanations"]) == math.prod(len(part["explanations"]) for part in parts)
    assert reply["complete"] and all(part["complete"] for part in parts)
    text = run(*ask).stdout
    assert text.startswith("2 parts") and text.count("init(runs(hall), false)") == 1


def test_diagnose_names_a_conflict_with_its_lines(tmp_path):
    file = tmp_path / "clash.hist"
    file.write_text("obs(on(left), true, 0).\nobs(on(right), true, 0).\nobs(dark, true, 0).\n")
    file.write_text(file.read_text() + "obs(on(left), false, 0).\n")
    reply = answer("diagnose", LAMPS, "--history", file)
    assert reply["consistent"] is False
    assert [(r["file"], r["line"]) for r in reply["conflict"]] == [(str(file), 1), (str(file), 4)]
    assert f"{file}:4" in run("diagnose", LAMPS, "--history", file).stdout
    assert run("diagnose", LAMPS, "--history", file, "--exit-code").returncode == 4
    assert run("entails", LAMPS, "--history", file, "--literal", "dark").returncode == 1


def test_plan_and_no_plan_are_answers(history):
    reply = answer("plan", LAMPS, "--history", history, "--goal", "lit(red)")
    assert [p["steps"] for p in reply["plans"]] == [[["flip(left)"]]]
    impossible = ("plan", LAMPS, "--history", history, "--goal", "dark and lit(red)")
    assert answer(*impossible)["plans"] == []
    assert run(*impossible).stdout.startswith("No plan: ")
    assert run(*impossible, "--exit-code").returncode == 4
    assert answer("plan", LAMPS, "--history", history, "--goal", "dark")["goal_entailed"] is True


def test_all_plans_and_costs_are_told(history):
    ask = ("plan", LAMPS, "--history", history, "--goal", "lit(red) and lit(green)")
    reply = answer(*ask, "--all")
    assert sorted(plan["steps"] for plan in reply["plans"]) == [
        [["flip(left)"], ["flip(right)"]],
        [["flip(right)"], ["flip(left)"]],
    ]
    assert [plan["cost"] for plan in reply["plans"]] == [2.0, 2.0]
    some = answer(*ask, "--all", "--max-plans", "1")
    assert (len(some["plans"]), some["complete"]) == (1, False)
    assert len(answer(*ask, "--cost", "--whole")["plans"]) == 1


def test_relevance_leaves_out_what_cannot_matter(history):
    reply = answer("relevant", LAMPS, "--history", history, "--goal", "lit(red)")
    names = {item["name"] for item in reply["fluents"]}
    assert "on(left)" in names and "shows(d)" not in names
    assert reply["considered"]["fluents"] == len(reply["fluents"]) < reply["whole"]["fluents"]


def test_a_program_is_printed_whole(history):
    text = run("translate", LAMPS, "--history", history, "--goal", "lit(red)").stdout
    assert f"% {LAMPS}:" in text and f"% {history}:1" in text
    assert "#program" not in text and "#external" not in text
    assert "_last = _now + 1." in text


QUESTIONS = {
    "check": (),
    "translate": (),
    "entails": ("--literal", "dark"),
    "explain": ("--literal", "dark"),
    "models": (),
    "diagnose": (),
    "plan": ("--goal", "lit(red)"),
    "relevant": ("--goal", "lit(red)"),
}


@pytest.mark.parametrize("command", sorted(QUESTIONS))
def test_every_command_tells_the_place_of_bad_input(command, tmp_path):
    ask = QUESTIONS[command]
    missing = run(command, tmp_path / "none.kr3", *ask)
    assert (missing.returncode, missing.stdout) == (1, "")
    assert "none.kr3" in missing.stderr
    broken = tmp_path / "broken.kr3"
    broken.write_bytes(b"sorts\n  lamp = {red}.\n  \x00\xff = {blue}.\n")
    result = run(command, broken, *ask)
    assert result.returncode == 1 and f"{broken}:3:3: " in result.stderr
    history = tmp_path / "wrong.hist"
    history.write_text("init(on(left), true).\nobs(on(middle), true, 1).\n")
    result = run(command, LAMPS, *ask, "--history", history, "--format", "json")
    assert result.returncode == 1 and f"{history}:2:5: " in result.stderr
    error = json.loads(result.stdout)
    assert error["command"] == command
    assert error["error"]["code"] == "INVALID_ARGUMENT"
    assert "middle" in error["error"]["message"]


@pytest.mark.parametrize(
    "question",
    [
        ("entails", "--literal", "lit(blue)"),
        ("entails", "--literal", "dark", "--step", "7"),
        ("explain", "--literal", "lit("),
        ("plan", "--goal", "lit(red) and"),
        ("diagnose", "--assume", "obs(dark)"),
        ("diagnose", "--default-weight", "nothing=2"),
        ("diagnose", "--default-weight", "sound=lots"),
    ],
    ids=" ".join,
)
def test_a_wrong_question_is_an_input_error(question):
    result = run(question[0], LAMPS, *question[1:])
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.strip()


@pytest.mark.parametrize(
    "arguments",
    [(), ("frobnicate",), ("check",), ("plan", LAMPS), ("models", LAMPS, "--limit", "0")],
    ids=" ".join,
)
def test_wrong_usage_exits_with_two(arguments):
    assert run(*arguments).returncode == 2


@pytest.mark.parametrize("command", sorted(QUESTIONS))
def test_help_shows_an_example(command):
    result = run(command, "--help")
    assert result.returncode == 0
    assert f"kr3_reason {command} domain.kr3" in result.stdout or "refinement" in result.stdout


def test_a_sparc_program_is_imported_and_can_be_planned_with(tmp_path):
    program = DATA / "delivery.sp"
    parts = {}
    for part in ("description", "history", "goals"):
        result = run("import-sparc", program, "--part", part)
        assert result.returncode == 0, result.stderr
        parts[part] = result.stdout
    (tmp_path / "domain.kr3").write_text(parts["description"])
    (tmp_path / "start.history").write_text(parts["history"])
    goal = parts["goals"].strip()
    reply = answer(
        "plan", tmp_path / "domain.kr3", "--history", tmp_path / "start.history", "--goal", goal
    )
    # room1 to room3 and back, one room at a time, with the mug
    assert len(reply["plans"][0]["steps"]) == 5
    assert answer("import-sparc", program)["goals"] == [goal]
    broken = tmp_path / "broken.sp"
    broken.write_text("sorts\n#room = .\n")
    result = run("import-sparc", broken)
    assert result.returncode == 1 and f"{broken}:2:" in result.stderr
