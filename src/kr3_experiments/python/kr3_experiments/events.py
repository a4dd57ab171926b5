"""What the executive reports, as lines for a terminal and rows for a report. Knows no ROS."""
import json
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Dict, List


class EventKind(IntEnum):
    """As in kr3_msgs/MissionEvent; a test keeps the two equal."""

    GOAL = 0
    PLAN = 1
    HL_ACTION = 2
    POLICY = 3
    LL_ACTION = 4
    RECORD = 5
    DIAGNOSIS = 6
    REPLAN = 7
    DONE = 8
    FAILED = 9
    CANCELLED = 10


END_KINDS = (EventKind.DONE, EventKind.FAILED, EventKind.CANCELLED)

_LABELS = {
    EventKind.GOAL: "goal",
    EventKind.PLAN: "plan",
    EventKind.HL_ACTION: "action",
    EventKind.POLICY: "policy",
    EventKind.LL_ACTION: "",
    EventKind.RECORD: "record",
    EventKind.DIAGNOSIS: "why",
    EventKind.REPLAN: "replan",
    EventKind.DONE: "done",
    EventKind.FAILED: "failed",
    EventKind.CANCELLED: "cancelled",
}

_COLOURS = {
    EventKind.GOAL: "1;36",
    EventKind.PLAN: "36",
    EventKind.HL_ACTION: "1;34",
    EventKind.POLICY: "2",
    EventKind.LL_ACTION: "0",
    EventKind.RECORD: "35",
    EventKind.DIAGNOSIS: "1;33",
    EventKind.REPLAN: "33",
    EventKind.DONE: "1;32",
    EventKind.FAILED: "1;31",
    EventKind.CANCELLED: "1;31",
}


@dataclass(frozen=True)
class Event:
    """One MissionEvent. `time_s`: simulated time since the mission's first event."""

    time_s: float
    sequence: int
    kind: EventKind
    hl_step: int
    text: str
    data: Dict[str, Any]

    @property
    def label(self) -> str:
        """One word for people."""
        return _LABELS[self.kind]


def event_from_message(message: Any, start_s: float) -> Event:
    """@param message  a kr3_msgs/MissionEvent; @param start_s  stamp of the mission's first event"""
    try:
        data = json.loads(message.data) if message.data else {}
    except json.JSONDecodeError:
        data = {}
    return Event(
        time_s=message.header.stamp.to_sec() - start_s,
        sequence=message.sequence,
        kind=EventKind(message.kind),
        hl_step=message.hl_step,
        text=message.text,
        data=data if isinstance(data, dict) else {"value": data},
    )


def terminal_line(event: Event, colour: bool) -> str:
    """The event as it scrolls by: simulated time, kind, text; further lines of the text are indented."""
    indent = " " * 22
    text = event.text.strip()
    if event.label and text.lower().startswith(event.label + ": "):
        text = text[len(event.label) + 2 :]
    text = text.replace("\n", "\n" + indent)
    if event.kind is EventKind.LL_ACTION:
        text = "- " + text
    line = f"{event.time_s:8.1f} s  {event.label:<10} {text}"
    return f"\033[{_COLOURS[event.kind]}m{line}\033[0m" if colour else line


def write_events(events: List[Event], file: Path) -> None:
    """One JSON object per line."""
    with file.open("w", encoding="utf-8") as output:
        for event in events:
            output.write(json.dumps({**asdict(event), "kind": event.kind.name}) + "\n")
