"""The raw rows of an experiment: a CSV file that survives interruptions."""
import csv
import io
import os
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Mapping, Sequence, Set, Tuple

from kr3_experiments.errors import Kr3Error

Row = Dict[str, Any]


def truth_cell(text: str) -> bool:
    """Reads what `cell` writes of a truth."""
    if text not in ("0", "1"):
        raise ValueError(f"found '{text}', expected 0 or 1")
    return text == "1"


# What every trial leaves, with the reader of each column. Points add their labels in front.
RESULT_COLUMNS: Dict[str, Callable[[str], Any]] = {
    "config": str,
    "commit": str,
    "seed": int,
    "truth": str,
    "declared": truth_cell,
    "goal_true": truth_cell,
    "hl_actions": int,
    "ll_actions": int,
    "duration_s": float,
    "backups": int,
    "policies": str,
    "reason": str,
}


def cell(value: Any) -> str:
    """A value as the file has it: exact, and the same on every machine; but a row is a line, also of long words."""
    if isinstance(value, bool):
        return "1" if value else "0"
    return repr(value) if isinstance(value, float) else " ".join(str(value).splitlines())


class RowStore:
    """`rows.csv` in a folder: rows are added a block at a time, each block as a whole.

    What cannot be read when the file is opened, such as a block cut short by a power failure, is moved to
    `rows.rejected.csv` with its line number and what is wrong; the rest is used.
    """

    def __init__(
        self,
        folder: Path,
        labels: Mapping[str, Callable[[str], Any]],
        results: Mapping[str, Callable[[str], Any]] = RESULT_COLUMNS,
    ):
        """Open the rows of a folder, which is made when there is none.

        @param labels  columns of the points with their readers. @param results  those of a trial: `config` and `seed`,
        which tell rows apart, and more. @throws Kr3Error  the folder cannot be written
        """
        self._readers: Dict[str, Callable[[str], Any]] = {**labels, **results}
        self.path = folder / "rows.csv"
        self.rejected_path = folder / "rows.rejected.csv"
        self.rows: List[Row] = []
        self.rejected: List[str] = []  # what was wrong, a line each
        self._keys: Set[Tuple[str, int]] = set()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._open()
        except OSError as error:
            raise Kr3Error(f"cannot write results to '{folder}': {error.strerror}") from error

    @property
    def columns(self) -> List[str]:
        """In the order of the file."""
        return list(self._readers)

    def has(self, config: str, seed: int) -> bool:
        """Whether the trial is there."""
        return (config, seed) in self._keys

    def add(self, rows: Iterable[Row]) -> None:
        """Write rows to the disk; those that are there already are left out."""
        new = [row for row in rows if not self.has(row["config"], row["seed"])]
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        for row in new:
            writer.writerow([cell(row[column]) for column in self.columns])
        with self.path.open("a", encoding="utf-8", newline="") as file:
            file.write(text.getvalue())
            file.flush()
            os.fsync(file.fileno())
        for row in new:
            self._keep(row)

    def of(self, configs: Sequence[str]) -> List[Row]:
        """Rows of these configurations, by configuration and seed: the order does not tell when they were made."""
        wanted = {config: i for i, config in enumerate(configs)}
        rows = [row for row in self.rows if row["config"] in wanted]
        return sorted(rows, key=lambda row: (wanted[row["config"]], row["seed"]))

    def _keep(self, row: Row) -> None:
        self._keys.add((row["config"], row["seed"]))
        self.rows.append(row)

    def _open(self) -> None:
        if not self.path.exists():
            self._rewrite([])
            return
        kept: List[str] = []
        bad: List[str] = []
        lines = self.path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
        header: List[str] = next(csv.reader(lines[:1]), [])
        if header != self.columns:
            what = f"found the columns {','.join(header) or '(none)'}"
            self._reject(lines, [f"{self.path.name}:1: {what}, expected {','.join(self.columns)}"])
            self._rewrite([])
            return
        for number, line in enumerate(lines[1:], start=2):
            problem = self._read(line)
            if problem:
                self.rejected.append(f"{self.path.name}:{number}: {problem}")
                bad.append(line)
            else:
                kept.append(line)
        if bad:
            self._reject(bad, [])
            self._rewrite(kept)

    def _read(self, line: str) -> str:
        """Keep the row of a line. @return what is wrong with it, or nothing"""
        if not line.endswith("\n"):
            return "the line is cut short"
        fields: List[str] = next(csv.reader([line]), [])
        if len(fields) != len(self._readers):
            return f"found {len(fields)} fields, expected {len(self._readers)}"
        row: Row = {}
        for (column, reader), text in zip(self._readers.items(), fields):
            try:
                row[column] = reader(text)
            except ValueError:
                return f"column {column}: found '{text}'"
        if self.has(row["config"], row["seed"]):
            return f"the trial {row['config']}, seed {row['seed']} is there already"
        self._keep(row)
        return ""

    def _reject(self, lines: Sequence[str], problems: Sequence[str]) -> None:
        self.rejected.extend(problems)
        with self.rejected_path.open("a", encoding="utf-8", newline="") as file:
            for problem in self.rejected:
                file.write(f"# {problem}\n")
            for line in lines:
                file.write(line if line.endswith("\n") else line + "\n")

    def _rewrite(self, lines: Sequence[str]) -> None:
        temporary = self.path.with_suffix(".csv.new")
        with temporary.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(self.columns)
            file.writelines(lines)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(self.path)
