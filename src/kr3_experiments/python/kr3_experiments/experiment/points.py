"""What a sweep consists of: points of a floor, a method and a rule that says what is true in each trial."""
import hashlib
import json
import random
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Sequence, Tuple

from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error

Scalar = Any  # str, int, float or bool: what a cell of a CSV file holds


@dataclass(frozen=True)
class Floor:
    """A floor of rooms as scripts/make_floor.py writes it."""

    rooms: int
    cells: int = 4  # of each room
    defaults: int = 3  # length of the chain of defaults
    layout: str = "grid"
    noise: float = 1.0  # of slips, looks and grasps, as a multiple of the models' error rates
    models: str = (
        "models.yaml"  # of the domain that floors are made from: the numbers that are multiplied
    )

    def options(self) -> List[str]:
        """For make_floor.py."""
        return [
            *("--rooms", str(self.rooms)),
            *("--cells", str(self.cells)),
            *("--defaults", str(self.defaults)),
            *("--layout", self.layout),
            *("--noise", f"{self.noise:g}"),
            *("--models", self.models),
        ]

    def write(self, folder: Path) -> None:
        """Write the files of the floor. @throws Kr3Error  the generator refuses the sizes"""
        script = repository_root() / "scripts" / "make_floor.py"
        done = subprocess.run(
            [sys.executable, str(script), str(folder), *self.options()],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            raise Kr3Error(f"no floor '{self}': {done.stderr.strip()}")


@dataclass(frozen=True)
class TargetRule:
    """Where the object asked for is: in room `usual` with probability `share`, else in any other, all alike.

    Without `usual` any of `rooms` rooms is as likely as another. The same seed draws the same number for every point,
    so that methods meet the same worlds.
    """

    rooms: int
    usual: str = ""
    share: float = 0.0
    fluent: str = "loc(b1)"
    prefix: str = "r"
    # The fluent of the room where the robot starts, any as likely; none: the scenario says.
    start: str = ""

    def room(self, seed: int) -> str:
        """Name of the room in the trial with this seed."""
        draw = random.Random(seed)
        obeys = draw.random() < self.share
        if self.usual and obeys:
            return self.usual
        rooms = [f"{self.prefix}{i + 1}" for i in range(self.rooms)]
        others = [room for room in rooms if room != self.usual]
        return others[int(draw.random() * len(others))]

    def truths(self, seed: int) -> List[str]:
        """Literals that are true in the world of this trial."""
        return [f"{self.fluent} = {self.room(seed)}"]

    def initially(self, seed: int) -> List[str]:
        """Literals that the robot knows at the start of this trial besides those of the scenario, or in their place."""
        if not self.start:
            return []
        room = 1 + int(random.Random(f"start {seed}").random() * self.rooms)
        return [f"{self.start} = {self.prefix}{room}"]

    def trial(self, seed: int) -> Dict[str, Any]:
        """As kr3_trials takes it."""
        trial: Dict[str, Any] = {"seed": seed, "truths": self.truths(seed)}
        if self.start:
            trial["initially"] = self.initially(seed)
        return trial


@dataclass(frozen=True)
class Point:
    """One configuration and the trials that are wanted of it.

    `label` holds the columns by which figures tell points apart; `job` the keys of kr3_trials besides the domain;
    `files` further files of the domain, name -> text, such as the models that `job` names for robot or world.
    """

    label: Mapping[str, Scalar]
    floor: Floor
    target: TargetRule
    job: Mapping[str, Scalar]
    seeds: Tuple[int, int]  # the first and the one after the last
    files: Mapping[str, str] = field(default_factory=dict)

    def all_seeds(self) -> range:
        """In the order in which they are run."""
        return range(*self.seeds)


@dataclass
class Configuration:
    """A point with its files written, and the hash of everything that its rows depend on besides the seed."""

    point: Point
    files: Mapping[str, str]  # name -> text, of the domain
    digest: str = field(init=False)

    def __post_init__(self) -> None:
        rule = self.point.target
        content = {
            "files": dict(self.files),
            "job": dict(self.point.job),
            "target": [rule.rooms, rule.usual, rule.share, rule.fluent, rule.prefix]
            + ([rule.start] if rule.start else []),
        }
        text = json.dumps(content, sort_keys=True)
        self.digest = hashlib.sha256(text.encode()).hexdigest()[:12]


def configurations(points: Sequence[Point], folder: Path) -> List[Configuration]:
    """Write each floor once, below `folder`, and read its files back."""
    texts: Dict[Floor, Dict[str, str]] = {}
    for point in points:
        if point.floor in texts:
            continue
        name = hashlib.sha256(" ".join(point.floor.options()).encode()).hexdigest()[:12]
        directory = folder / name
        point.floor.write(directory)
        texts[point.floor] = {
            path.name: path.read_text(encoding="utf-8") for path in sorted(directory.iterdir())
        }
    return [Configuration(point, {**texts[point.floor], **point.files}) for point in points]
