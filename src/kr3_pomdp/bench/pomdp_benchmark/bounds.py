"""Bounds at given CPU times for each problem, beside the peer's; time to the peer's gap; memory."""

import statistics

from .figures import Figure, geometric_mean
from .goals import (
    MEAN_TIME_S,
    MEMORY_SHARE,
    PEER_MEMORY_MB,
    REFERENCES,
    ROOMS,
    WORST_TIME_S,
    Bounds,
    Reference,
)
from .processes import Trace
from .session import Session, room_file

MEGABYTE = 1e6
# Below this a ratio of gaps says nothing.
SOLVED_GAP = 1e-3
HEADER = (
    f"{'problem':<24} {'CPU s':>6} {'lower':>10} {'upper':>10} {'gap':>9} {'backups':>9} {'vectors':>8}"
    f" {'MB':>6}   APPL: gap, in our gaps"
)


def measure(session: Session, problems: list[str]) -> None:
    """One run a problem and solver, alternating; bounds are read off as they come."""
    print(f"\nBounds at the start belief after CPU seconds\n{HEADER}")
    to_gap: dict[str, float | None] = {}
    for problem in problems:
        model = session.file(problem)
        longest = max(session.times)
        trace = session.programs.solve(model, ["--cpu-time", repr(longest)])
        peer = session.peer.solve(model, longest) if session.peer else None
        reference = reference_of(model.name)
        for time_s in session.times:
            _row(session, model.name, trace, peer, reference, time_s)
        _memory(session, model.name, trace, peer)
        _upper_goal(session, model.name, trace, reference)
        wanted = _peer_gap(peer, reference, longest)
        if wanted is not None and model.name in REFERENCES:
            to_gap[model.name] = trace.time_to_gap(wanted)
    _times_to_gap(session, to_gap)


def reference_of(name: str) -> Reference | None:
    rooms = {room_file(cells): Reference(peer=room.peer) for cells, room in ROOMS.items()}
    return REFERENCES.get(name) or rooms.get(name)


def _row(
    session: Session,
    name: str,
    trace: Trace,
    peer: Trace | None,
    reference: Reference | None,
    time_s: float,
) -> None:
    point = trace.at(time_s)
    if point is None:
        print(f"{name:<24} {time_s:6g} no bounds yet")
        session.figures.append(Figure("gap", None, params={"problem": name, "time_s": time_s}))
        return
    bounds = point.bounds
    peers = peer_bounds(peer, reference, time_s)
    beside = f"{peers.gap:9.4f}" if peers else ""
    if peers and bounds.gap > SOLVED_GAP:
        beside += f" {peers.gap / bounds.gap:6.2f}"
    print(
        f"{name:<24} {time_s:6g} {bounds.lower:10.4f} {bounds.upper:10.4f} {bounds.gap:9.4f}"
        f" {point.backups:9d} {point.vectors:8d} {point.peak_bytes / MEGABYTE:6.0f} {beside}",
        flush=True,
    )
    params = {
        "problem": name,
        "time_s": time_s,
        "lower": bounds.lower,
        "upper": bounds.upper,
        "backups": point.backups,
        "vectors": point.vectors,
        "peak_bytes": point.peak_bytes,
        "cpu_s": point.cpu_s,
    }
    if peers:
        params |= {"peer_lower": peers.lower, "peer_upper": peers.upper}
    session.figures.append(Figure("gap", bounds.gap, params=params))


def peer_bounds(peer: Trace | None, reference: Reference | None, time_s: float) -> Bounds | None:
    """The peer's bounds at a time: of this session where it ran, else published."""
    if peer is not None:
        point = peer.at(time_s)
        return point.bounds if point else None
    return reference.peer.get(time_s) if reference else None


def _peer_gap(peer: Trace | None, reference: Reference | None, longest: float) -> float | None:
    """The gap that the peer has after 60 s; of this session when it ran so long."""
    if peer is not None and longest >= 60.0:
        return peer.last.bounds.gap
    published = reference.peer.get(60.0) if reference else None
    return published.gap if published else None


def _memory(session: Session, name: str, trace: Trace, peer: Trace | None) -> None:
    """Goal (f); without a verdict in runs that are shorter than the goal's 60 s."""
    most = peer.peak_bytes / MEGABYTE if peer else PEER_MEMORY_MB.get(name)
    goal = most * MEMORY_SHARE if most and max(session.times) >= 60.0 else None
    params = {"problem": name} | ({"peer_MB": round(most)} if most else {})
    session.figures.append(
        Figure("peak memory", trace.peak_bytes / MEGABYTE, "MB", goal, "lower", params)
    )


def _upper_goal(session: Session, name: str, trace: Trace, reference: Reference | None) -> None:
    if reference is not None and reference.upper is not None and max(session.times) >= 60.0:
        point = trace.at(60.0)
        session.figures.append(
            Figure(
                "upper bound by 60 s",
                point.bounds.upper if point else None,
                goal=reference.upper,
                better="lower",
                params={"problem": name},
            )
        )


def _times_to_gap(session: Session, to_gap: dict[str, float | None]) -> None:
    """Goal (a); without a verdict where runs are shorter than the goal. All must be reached for the mean."""
    if not to_gap:
        return
    print("\nTime to the gap that APPL has after 60 s")
    judged = max(session.times) >= WORST_TIME_S
    for name, time_s in to_gap.items():
        goal = WORST_TIME_S if judged else None
        params = {"problem": name}
        session.add(Figure("time to APPL's gap", time_s, "s", goal, "lower", params))
    times = [max(time_s, 1e-3) for time_s in to_gap.values() if time_s is not None]
    goal = MEAN_TIME_S if judged else None
    mean = geometric_mean(times) if len(times) == len(to_gap) else None
    params = {"problems": len(to_gap), "reached": len(times)}
    session.add(Figure("time to APPL's gap, geometric mean", mean, "s", goal, "lower", params))


def time_to_solve(session: Session, problems: list[str]) -> None:
    """Goal (c): CPU seconds to a gap of 1e-3, median."""
    print("\nTime to a gap of 1e-3, median")
    for problem in problems:
        model = session.file(problem)
        ours, theirs = [], []
        for _ in range(session.runs):
            trace = session.programs.solve(model, ["--cpu-time", "10"], precision=1e-3)
            ours.append(trace.time_to_gap(1e-3))
            if session.peer:
                theirs.append(session.peer.solve(model, 10.0, precision=1e-3).time_to_gap(1e-3))
        goal = REFERENCES[model.name].solved_s if model.name in REFERENCES else None
        params = {"problem": model.name}
        session.add(_median("time to 1e-3", ours, goal, params))
        if theirs:
            session.add(_median("time to 1e-3, peer", theirs, None, params))


def _median(name: str, times: list[float | None], goal: float | None, params: dict) -> Figure:
    if any(time_s is None for time_s in times):
        return Figure(name, None, "s", goal, "lower", params)
    return Figure(name, statistics.median(times), "s", goal, "lower", params, runs=list(times))
