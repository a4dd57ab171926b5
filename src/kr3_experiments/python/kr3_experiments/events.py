"""What the executive reports, as lines for a terminal and rows for a report. Knows no ROS."""
import json
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Dict, List, Tuple


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


def split_text(event: Event) -> Tuple[str, str]:
    """What happened, and for a low-level action the belief after it (else empty), without the label's own word."""
    text = event.text.strip()
    for separator in (": ", " "):
        if event.label and text.lower().startswith(event.label + separator):
            text = text[len(event.label + separator) :]
            break
    if event.kind is not EventKind.LL_ACTION:
        return text, ""
    happened, _, belief = text.partition("; ")
    return happened, belief


def terminal_line(event: Event, colour: bool) -> str:
    """The event as it scrolls by; the belief after a low-level action is on a line of its own."""
    indent = " " * 22
    text, belief = split_text(event)
    if event.kind is EventKind.LL_ACTION:
        text = "- " + text
    line = f"{event.time_s:8.1f} s  {event.label:<10} {text}".replace("\n", "\n" + indent)
    if colour:
        line = f"\033[{_COLOURS[event.kind]}m{line}\033[0m"
    if belief:
        belief = f"{indent}    {belief}"
        line += "\n" + (f"\033[2m{belief}\033[0m" if colour else belief)
    return line


def write_events(events: List[Event], file: Path) -> None:
    """One JSON object per line."""
    with file.open("w", encoding="utf-8") as output:
        for event in events:
            output.write(json.dumps({**asdict(event), "kind": event.kind.name}) + "\n")
