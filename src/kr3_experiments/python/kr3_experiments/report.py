"""The report of a mission: one HTML file with its pictures inside. Knows no ROS."""
import base64
import html
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle as Patch

from kr3_experiments.domain import Rectangle
from kr3_experiments.events import Event, EventKind, split_text

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1d2733; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; } h2 { margin-top: 2.2rem; font-size: 1.2rem; }
.verdict { padding: .7rem 1rem; border-radius: .4rem; font-weight: 600; }
.good { background: #dff3e4; color: #14532d; } .bad { background: #fde2e1; color: #7f1d1d; }
table { border-collapse: collapse; width: 100%; } td, th { padding: .25rem .7rem .25rem 0; text-align: left;
vertical-align: top; border-bottom: 1px solid #e3e8ee; } td.number { text-align: right; white-space: nowrap; }
tr.hl td { font-weight: 600; background: #eef4fb; } tr.why td { background: #fff7e0; } tr.record td { color: #6b2e82; }
tr.failed td, tr.cancelled td { background: #fde2e1; } tr.done td { background: #dff3e4; }
td pre { margin: 0; white-space: pre-wrap; font: inherit; }
img { max-width: 100%; border: 1px solid #d5dbe3; border-radius: .3rem; } .muted { color: #66727f; }
"""

_ROW_CLASSES = {
    EventKind.HL_ACTION: "hl",
    EventKind.DIAGNOSIS: "why",
    EventKind.REPLAN: "why",
    EventKind.RECORD: "record",
    EventKind.DONE: "done",
    EventKind.FAILED: "failed",
    EventKind.CANCELLED: "cancelled",
}


@dataclass(frozen=True)
class GridMap:
    """An occupancy grid. `cells`: shape [rows, columns], row 0 at the smallest y; -1 unknown, 0 free, 100 occupied."""

    cells: np.ndarray
    resolution: float  # m
    x_min: float  # m, map frame
    y_min: float


@dataclass(frozen=True)
class MissionRecord:
    """Everything that the report shows."""

    title: str
    goal: str
    success: bool
    reason: str
    figures: Mapping[str, Any]  # name -> value, as in summary.json
    events: Sequence[Event]
    places: Mapping[str, Rectangle]
    trajectory: Sequence[Tuple[float, float, float]]  # time s, x m, y m; map frame
    grid: Optional[GridMap] = None
    found_image: Optional[np.ndarray] = None  # uint8, shape [rows, columns, 3], RGB
    found_what: List[str] = field(default_factory=list)


def write_report(record: MissionRecord, file: Path) -> None:
    """Write the page."""
    file.write_text(report_html(record), encoding="utf-8")


def report_html(record: MissionRecord) -> str:
    """The page as text; pictures are embedded as PNG."""
    verdict = "good" if record.success else "bad"
    word = "Success" if record.success else "Failure"
    parts = [
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'>",
        f"<title>{html.escape(record.title)}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{html.escape(record.title)}</h1>",
        f"<p>Goal: <code>{html.escape(record.goal)}</code></p>",
        f"<p class='verdict {verdict}'>{word}: {html.escape(record.reason)}</p>",
        "<h2>Figures</h2>",
        _figures_table(record.figures),
        "<h2>Where the robot drove</h2>",
        _image(trajectory_png(record), "The robot's path on its map"),
        "<h2>The find</h2>",
        _found(record),
        "<h2>The plan as executed</h2>",
        _plan_table(record.events),
        "<h2>The mission's history</h2>",
        _history_table(record.events),
        "</body></html>",
    ]
    return "\n".join(parts)


def trajectory_png(record: MissionRecord) -> bytes:
    """The path, coloured by time, on the map with the places' borders and names; PNG."""
    figure = Figure(figsize=(9, 7), layout="constrained")
    axes = figure.add_subplot()
    if record.grid is not None:
        grid = record.grid
        rows, columns = grid.cells.shape
        shade = np.full(grid.cells.shape, 0.85)
        shade[grid.cells == 0] = 1.0
        shade[grid.cells > 50] = 0.15
        extent = (
            grid.x_min,
            grid.x_min + columns * grid.resolution,
            grid.y_min,
            grid.y_min + rows * grid.resolution,
        )
        axes.imshow(
            shade,
            origin="lower",
            extent=extent,
            cmap="gray",
            vmin=0,
            vmax=1,
            interpolation="nearest",
        )
    for name, area in record.places.items():
        width, height = area.x_max - area.x_min, area.y_max - area.y_min
        axes.add_patch(
            Patch(
                (area.x_min, area.y_min),
                width,
                height,
                fill=False,
                edgecolor="#3b82c4",
                linewidth=0.8,
            )
        )
        axes.text(
            area.x_min + width / 2,
            area.y_max - 0.3,
            name,
            ha="center",
            va="top",
            color="#1f5c99",
            fontsize=9,
        )
    if record.trajectory:
        times, xs, ys = (np.array(column) for column in zip(*record.trajectory))
        points = axes.scatter(xs, ys, c=times - times[0], s=6, cmap="plasma", zorder=3)
        figure.colorbar(points, ax=axes, label="simulated time, s", shrink=0.7)
        axes.plot(xs[0], ys[0], "o", color="#15803d", markersize=9, label="start", zorder=4)
        axes.plot(xs[-1], ys[-1], "s", color="#b91c1c", markersize=8, label="end", zorder=4)
        axes.legend(loc="upper right")
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    return _png(figure)


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def _image(png: bytes, caption: str) -> str:
    data = base64.b64encode(png).decode("ascii")
    return f"<img alt='{html.escape(caption)}' src='data:image/png;base64,{data}'>"


def _found(record: MissionRecord) -> str:
    if record.found_image is None:
        return "<p class='muted'>No search found its object.</p>"
    rows, columns = record.found_image.shape[:2]
    figure = Figure(figsize=(columns / 80, rows / 80), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.imshow(record.found_image)
    axes.set_axis_off()
    what = html.escape(", ".join(record.found_what))
    return (
        _image(_png(figure), "Camera frame of the find")
        + f"<p class='muted'>The robot's camera: {what}</p>"
    )


def _figures_table(figures: Mapping[str, Any]) -> str:
    rows = []
    for name, value in figures.items():
        shown = f"{value:.2f}" if isinstance(value, float) else str(value)
        rows.append(
            f"<tr><td>{html.escape(name.replace('_', ' '))}</td><td>{html.escape(shown)}</td></tr>"
        )
    return f"<table>{''.join(rows)}</table>"


def _plan_table(events: Sequence[Event]) -> str:
    """One row per high-level action with its time and its number of low-level actions."""
    rows: List[List[str]] = []
    low_level = 0
    for event in events:
        if event.kind is EventKind.HL_ACTION:
            if rows:
                rows[-1][3] = str(low_level)
            low_level = 0
            action = str(event.data.get("action", event.text))
            rows.append([f"{event.time_s:.1f}", str(event.hl_step), action, ""])
        elif event.kind is EventKind.LL_ACTION:
            low_level += 1
    if not rows:
        return "<p class='muted'>No high-level action was started.</p>"
    rows[-1][3] = str(low_level)
    cells = "".join(
        f"<tr><td class='number'>{time_s}</td><td class='number'>{step}</td><td>{html.escape(text)}</td>"
        f"<td class='number'>{count}</td></tr>"
        for time_s, step, text, count in rows
    )
    return f"<table><tr><th>start, s</th><th>step</th><th>action</th><th>low-level actions</th></tr>{cells}</table>"


def _history_table(events: Sequence[Event]) -> str:
    rows = ""
    for event in events:
        text, belief = split_text(event)
        shown = f"<pre>{html.escape(text)}</pre>"
        if belief:
            shown += f"<pre class='muted'>{html.escape(belief)}</pre>"
        rows += (
            f"<tr class='{_ROW_CLASSES.get(event.kind, '')}'><td class='number'>{event.time_s:.1f}</td>"
            f"<td>{event.label or 'low level'}</td><td>{shown}</td></tr>"
        )
    return f"<table><tr><th>time, s</th><th></th><th></th></tr>{rows}</table>"
