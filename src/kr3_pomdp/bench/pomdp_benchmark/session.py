"""What the sections of the benchmark share: programs, problems, times, and the figures so far."""

import pathlib
from dataclasses import dataclass, field

from benchmark_models import flat_file, network_file
from benchmark_models.catalogue import PROBLEMS

from .figures import Figure
from .goals import REFERENCES, ROOMS
from .peer import Peer
from .processes import BenchmarkError, Programs

FORMATS = (".pomdp", ".pomdpx")


@dataclass
class Session:
    """One run of the benchmark.

    data: folder with the published files; None = generated problems
    scratch: for files that it writes
    runs: repetitions of what is short
    """

    programs: Programs
    scratch: pathlib.Path
    data: pathlib.Path | None
    peer: Peer | None
    times: tuple[float, ...]
    runs: int
    trials: int
    seed: int
    figures: list[Figure] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.data is not None and not self.data.is_dir():
            raise BenchmarkError(
                f"found no folder {self.data}, expected the published problems there"
            )
        if not self.times or min(self.times) <= 0.0:
            raise BenchmarkError(f"found times {self.times}, expected positive seconds")

    def add(self, figure: Figure) -> None:
        """Keeps a figure and prints it."""
        self.figures.append(figure)
        print(figure, flush=True)

    def known(self) -> list[str]:
        """The problems of the goals that can be had here."""
        names = [*REFERENCES, *(room_file(cells) for cells in ROOMS)]
        return [name for name in names if name in PROBLEMS or self._published(name)]

    def file(self, problem: str) -> pathlib.Path:
        """The model file of a problem: its name, with or without ending, or a path.

        @raises BenchmarkError  unknown
        """
        for name in (problem, *(problem + ending for ending in FORMATS)):
            source = self._source(name)
            if source is not None:
                return source
        path = pathlib.Path(problem)
        if path.suffix in FORMATS and path.is_file():
            return path
        expected = ", ".join(self.known())
        raise BenchmarkError(
            f"unknown problem '{problem}', expected a model file or one of {expected}"
        )

    def generated(self, name: str) -> pathlib.Path:
        """A problem of the catalogue, written once."""
        path = self.scratch / name
        if not path.exists():
            writer = network_file if name.endswith("x") else flat_file
            with open(path, "w", encoding="utf-8") as out:
                writer.write(PROBLEMS[name].build(), out)
        return path

    def _published(self, name: str) -> pathlib.Path | None:
        path = self.data / name if self.data is not None else None
        return path if path is not None and path.is_file() else None

    def _source(self, name: str) -> pathlib.Path | None:
        return self._published(name) or (self.generated(name) if name in PROBLEMS else None)


def room_file(cells: int) -> str:
    return f"RoomSearch_{cells}.pomdp"
