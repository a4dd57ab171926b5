"""Run APPL's pomdpsol and read its table of bounds over time."""

import math
import pathlib
import re
import tempfile

from .goals import Bounds
from .processes import BenchmarkError, Point, Trace, run


def read_table(output: str, peak_bytes: int = 0) -> Trace:
    """The rows of pomdpsol's table; its time is CPU seconds from the end of loading.

    @raises BenchmarkError  there are none
    """
    points = []
    in_table = False
    for line in output.splitlines():
        if "|LBound" in line and "|UBound" in line:
            in_table = True
        fields = line.split()
        if not in_table or len(fields) != 8 or not re.match(r"[0-9.]", fields[0]):
            continue
        time_s, backups, vectors = float(fields[0]), int(fields[2]), int(fields[6])
        bounds = Bounds(float(fields[3]), float(fields[4]))
        if math.isfinite(bounds.gap):
            points.append(Point(time_s, time_s, bounds, backups, vectors, peak_bytes))
    if not points:
        raise BenchmarkError(f"the peer printed no bounds: {output.strip()[-300:]}")
    return Trace(tuple(points), peak_bytes=peak_bytes)


class Peer:
    """A pomdpsol binary.

    @raises BenchmarkError  it is missing
    """

    def __init__(self, binary: pathlib.Path) -> None:
        if not binary.is_file():
            raise BenchmarkError(f"found no peer at {binary}, expected APPL's pomdpsol")
        self.binary = binary.resolve()

    def solve(self, model: pathlib.Path, cpu_s: float, precision: float = 1e-9) -> Trace:
        with tempfile.TemporaryDirectory() as folder:
            output, peak_bytes = run(
                [
                    str(self.binary),
                    *("--timeout", repr(cpu_s), "--precision", repr(precision)),
                    *("--output", str(pathlib.Path(folder) / "policy"), str(model)),
                ]
            )
        return read_table(output, peak_bytes)
