"""The room search family: bounds and simulated values of our policies beside a greedy rule."""

import math

from .bounds import peer_bounds
from .figures import Figure
from .goals import ROOMS, Bounds, Reference, RoomReference
from .processes import Trace
from .room_floor import Floor, greedy_floor
from .session import Session, room_file


def measure(session: Session, sizes: list[int], times: tuple[float, ...]) -> None:
    """For each size a run of its own to each time, so that its policy can be simulated."""
    print(f"\nRoom search: simulated values, {session.trials} trials, beside the greedy rule")
    for cells in sizes:
        floor = greedy_floor(cells, max(session.trials, 2000), session.seed)
        name = room_file(cells)
        params = {"problem": name, "standard_error": floor.standard_error}
        session.add(Figure("greedy rule", floor.mean, params=params))
        longest: Trace | None = None
        for time_s in times:
            longest = _policy_at(session, cells, time_s, floor)
        if longest is not None:
            _goals(session, cells, longest, max(times))


def _policy_at(session: Session, cells: int, time_s: float, floor: Floor) -> Trace:
    model = session.file(room_file(cells))
    policy = session.scratch / "policy"
    trace = session.programs.solve(model, ["--cpu-time", repr(time_s)], policy=policy)
    mean, low, high = session.programs.simulate(model, policy, session.trials, session.seed)
    bounds = trace.last.bounds
    beside = peer_bounds(None, _reference(ROOMS.get(cells)), time_s)
    print(
        f"{room_file(cells):<24} {time_s:6g} s  bounds {bounds.lower:8.3f} {bounds.upper:8.3f}"
        + (f"  APPL {beside.lower:7.2f} {beside.upper:6.2f}" if beside else "")
    )
    params = {"problem": model.name, "time_s": time_s, "low": low, "high": high}
    # Both are estimates: a value is below the rule's when the difference is significant (95 %).
    least = floor.mean - math.hypot(high - mean, 1.96 * floor.standard_error)
    session.add(Figure("simulated value", mean, "", least, "higher", params))
    return trace


def _reference(room: RoomReference | None) -> Reference | None:
    return Reference(peer=room.peer) if room else None


def _goals(session: Session, cells: int, trace: Trace, longest: float) -> None:
    for goal in ROOMS[cells].goals if cells in ROOMS else ():
        point = trace.at(goal.time_s)
        if goal.time_s <= longest and point is not None:
            value = _of(goal.kind, point.bounds)
            better = "higher" if goal.kind == "lower" else "lower"
            params = {"problem": room_file(cells), "time_s": goal.time_s}
            name = "gap" if goal.kind == "gap" else f"{goal.kind} bound"
            session.add(Figure(name, value, "", goal.value, better, params))


def _of(kind: str, bounds: Bounds) -> float:
    return {"lower": bounds.lower, "upper": bounds.upper, "gap": bounds.gap}[kind]
