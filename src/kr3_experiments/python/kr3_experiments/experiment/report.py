"""Reports of experiments, as Markdown and as HTML with the figures beside it."""
import html
import os
import platform
from datetime import datetime, timezone
from pathlib import Path
from typing import List, Mapping, Sequence

import markdown

from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.definition import Findings, Table, save_figures

_STYLE = """
body { font: 15px/1.55 system-ui, sans-serif; color: #1d2733; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { margin-top: 2.4rem; font-size: 1.3rem; } h3 { font-size: 1.05rem; }
table { border-collapse: collapse; font-size: .87rem; } td, th { padding: .22rem .8rem .22rem 0; text-align: left;
border-bottom: 1px solid #e3e8ee; } img { max-width: 100%; } blockquote { margin: 0; color: #475569; }
code { background: #f1f5f9; padding: 0 .2rem; }
"""


def machine() -> str:
    """Processor, cores and system, for the report."""
    name = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    return f"{name}, {os.cpu_count()} cores, {platform.system()} {platform.release()}"


def table_text(table: Table) -> List[str]:
    """Lines of Markdown."""
    lines = [f"### {table.title}", ""]
    lines.append("| " + " | ".join(table.header) + " |")
    lines.append("|" + "---|" * len(table.header))
    lines += ["| " + " | ".join(row) + " |" for row in table.rows]
    return [*lines, ""]


def section(
    title: str,
    claim: str,
    protocol: str,
    findings: Findings,
    notes: Sequence[str],
    prefix: str = "",
) -> List[str]:
    """One experiment. @param prefix  of the paths of its figures"""
    lines = [f"## {title}", "", f"> The paper: {claim}", "", protocol, ""]
    lines += [f"- {statement}" for statement in findings.statements]
    lines.append("")
    for name in findings.figures:
        lines += [f"![{name.replace('_', ' ')}]({prefix}{name}.png)", ""]
    for table in findings.tables:
        lines += table_text(table)
    lines += [f"- {note}" for note in notes]
    return [*lines, ""]


def head(title: str, facts: Mapping[str, str]) -> List[str]:
    """The top of a report."""
    lines = [f"# {title}", ""]
    lines += [f"- {name}: {value}" for name, value in facts.items()]
    lines.append(f"- machine: {machine()}")
    lines.append(f"- written: {datetime.now(timezone.utc):%Y-%m-%d %H:%M} UTC")
    return [*lines, ""]


def write_report(folder: Path, title: str, lines: Sequence[str], findings: Findings) -> Path:
    """Write `report.md`, `report.html` and the figures.

    @return the HTML file. @throws Kr3Error  the folder cannot be written
    """
    text = "\n".join(lines)
    body = markdown.markdown(text, extensions=["tables"])
    page = (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        save_figures(findings.figures, folder)
        (folder / "report.md").write_text(text, encoding="utf-8")
        (folder / "report.html").write_text(page, encoding="utf-8")
    except OSError as error:
        raise Kr3Error(f"cannot write the report to '{folder}': {error.strerror}") from error
    return folder / "report.html"
