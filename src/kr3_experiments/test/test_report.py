"""Events become lines and rows; the report is one file that holds everything."""
import json

import numpy as np

from kr3_experiments.domain import Rectangle
from kr3_experiments.events import Event, EventKind, event_from_message, terminal_line, write_events
from kr3_experiments.report import GridMap, MissionRecord, report_html


class FakeStamp:
    def to_sec(self):
        return 12.5


class FakeHeader:
    stamp = FakeStamp()


class FakeMessage:
    header = FakeHeader()
    sequence = 3
    kind = 6
    hl_step = 2
    text = "the cup was not there"
    data = '{"exceptions": ["e"]}'


def event(kind, text, time_s=0.0, step=0):
    return Event(time_s, 0, kind, step, text, {})


def test_a_message_becomes_an_event():
    read = event_from_message(FakeMessage(), 10.0)
    assert (read.time_s, read.kind, read.data) == (2.5, EventKind.DIAGNOSIS, {"exceptions": ["e"]})


def test_malformed_data_is_dropped_not_fatal():
    message = FakeMessage()
    message.data = "{"
    assert event_from_message(message, 0.0).data == {}


def test_a_label_is_not_said_twice():
    line = terminal_line(event(EventKind.PLAN, "plan: move"), colour=False)
    assert line.split() == ["0.0", "s", "plan", "move"]


def test_colour_wraps_the_line_only_if_wanted():
    failed = event(EventKind.FAILED, "no plan")
    assert "\033[" not in terminal_line(failed, colour=False)
    assert terminal_line(failed, colour=True).endswith("\033[0m")


def test_events_are_written_one_a_line(tmp_path):
    events = [event(EventKind.GOAL, "a"), event(EventKind.DONE, "b")]
    write_events(events, tmp_path / "events.jsonl")
    kinds = [
        json.loads(line)["kind"] for line in (tmp_path / "events.jsonl").read_text().splitlines()
    ]
    assert kinds == ["GOAL", "DONE"]


def record(**changes):
    values = {
        "title": "Mission",
        "goal": "at(cup) = shelf",
        "success": True,
        "reason": "it is there",
        "figures": {"mission_wall_s": 1.234, "seed": 1},
        "events": [
            event(EventKind.HL_ACTION, "step 0: go", 0.5, 0),
            event(EventKind.LL_ACTION, "drive"),
            event(EventKind.LL_ACTION, "look"),
            event(EventKind.HL_ACTION, "step 1: take", 9.5, 1),
            event(EventKind.DIAGNOSIS, "<because> & so"),
        ],
        "places": {"shelf": Rectangle(0.0, 0.0, 2.0, 1.0)},
        "trajectory": [(0.0, 0.1, 0.1), (1.0, 0.5, 0.2)],
    }
    values.update(changes)
    return MissionRecord(**values)


def test_the_report_holds_verdict_plan_history_and_pictures():
    grid = GridMap(np.zeros((4, 8), dtype=np.int8), 0.25, 0.0, 0.0)
    image = np.zeros((24, 32, 3), dtype=np.uint8)
    page = report_html(record(grid=grid, found_image=image, found_what=["cup"]))
    assert "Success: it is there" in page
    assert page.count("data:image/png;base64,") == 2
    assert "<td>step 0: go</td><td class='number'>2</td>" in page
    assert "&lt;because&gt; &amp; so" in page
    assert "http" not in page  # nothing is loaded from elsewhere


def test_a_mission_that_never_started_still_has_a_report():
    page = report_html(record(success=False, reason="no plan", events=[], trajectory=[]))
    assert "Failure: no plan" in page
    assert "No search found its object" in page
    assert "No high-level action was started" in page
