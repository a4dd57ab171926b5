"""A domain's folder as bring-up and demo see it: its files and its scenario. Knows no ROS."""
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Collection, Dict, List, Mapping, Optional

from kr3_experiments.errors import Kr3Error
from kr3_experiments.yaml_file import read_mapping

_SCENARIO_KEYS = ("initial_records", "goal", "target", "placements")
_TARGET_KEYS = ("object", "at", "goal_place", "may_be_at")


def repository_root() -> Path:
    """The repository: ./kr3 says where it is; otherwise it is found from this file."""
    if "KR3_ROOT" in os.environ:
        return Path(os.environ["KR3_ROOT"])
    return Path(__file__).resolve().parents[4]


@dataclass(frozen=True)
class Rectangle:
    """Axis-aligned, in the map frame, m."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float

    def contains(self, x: float, y: float) -> bool:
        """Whether a point is inside or on the border."""
        return self.x_min <= x <= self.x_max and self.y_min <= y <= self.y_max


@dataclass(frozen=True)
class Target:
    """What the mission of the demo is about."""

    object: str
    goal_place: str
    at: str  # where it really is, unless --target-at says otherwise
    may_be_at: List[str]  # places that tests draw from


@dataclass(frozen=True)
class Domain:
    """Everything that is read from `domains/NAME`."""

    name: str
    folder: Path
    goal: str
    robot_start: List[float]  # x, y in m, yaw in rad; map frame
    initial_records: List[Mapping[str, Any]]
    target: Target
    placements: Dict[
        str, str
    ]  # object -> place, where it differs from the building's own; the target excluded
    places: Dict[str, Rectangle]

    @property
    def scenario_file(self) -> Path:
        """The file that the executive reads its initial records from."""
        return self.folder / "scenario.yaml"

    @property
    def map_file(self) -> Path:
        """The OctoMap of the building."""
        return self.folder / "map.bt"

    def require_place(self, place: str) -> None:
        """@throws Kr3Error  it is no place of the domain"""
        if place not in self.places:
            raise Kr3Error(
                f"'{place}' is no place of the domain {self.name}: there are {', '.join(sorted(self.places))}"
            )

    def place_at(self, x: float, y: float) -> Optional[str]:
        """The place of a point of the map frame, m; None outside of all."""
        return next((name for name, area in self.places.items() if area.contains(x, y)), None)

    def placements_with_target(self, place: str) -> List[str]:
        """ "object=place" for every object that is not where the building has it. @throws Kr3Error  unknown place"""
        self.require_place(place)
        placements = {**self.placements, self.target.object: place}
        return [f"{item}={where}" for item, where in sorted(placements.items())]

    def target_fluent(self) -> str:
        """The fluent that says where the target is, as the goal writes it: "f(x)" of "f(x) = place".

        @throws Kr3Error  the goal does not say where the target has to be
        """
        target = self.target
        pattern = rf"(\w+\([^()]*\b{re.escape(target.object)}\b[^()]*\))\s*=\s*{re.escape(target.goal_place)}\b"
        found = re.search(pattern, self.goal)
        if found is None:
            raise Kr3Error(
                f"{self.scenario_file}: the goal '{self.goal}' does not say that"
                f" {target.object} has to be at {target.goal_place}"
            )
        return found.group(1)

    @property
    def model_file(self) -> Path:
        """What the detector has learned about the domain's objects."""
        return self.folder / "perception.yml.gz"

    def require_model(self) -> None:
        """@throws Kr3Error  nothing was learned about the domain's objects yet"""
        if not self.model_file.is_file():
            raise Kr3Error(
                f"there is no model {self.model_file}: learn it with ./kr3 train {self.name}"
            )

    def require_map(self) -> None:
        """@throws Kr3Error  the domain has no map yet"""
        if not self.map_file.is_file():
            raise Kr3Error(f"there is no map {self.map_file}: build it with ./kr3 map {self.name}")


def find_folder(name: str, root: Path) -> Path:
    """`domains/NAME`, or the folder of this path (with a slash in it). @throws Kr3Error  there is none"""
    is_path = "/" in name
    folder = Path(name).resolve() if is_path else root / "domains" / name
    if is_path and not folder.is_dir():
        raise Kr3Error(f"there is no folder '{name}'")
    if not folder.is_dir():
        known = sorted(entry.name for entry in (root / "domains").glob("*") if entry.is_dir())
        raise Kr3Error(f"there is no domain '{name}'; there are {', '.join(known) or 'none'}")
    return folder


def load_domain(name: str, root: Path) -> Domain:
    """Read `domains/NAME`, or the folder of this path. @throws Kr3Error  a file or a key is missing or wrong"""
    folder = find_folder(name, root)
    file = folder / "scenario.yaml"
    scenario = read_mapping(file)
    building_file = folder / "building.yaml"
    building = read_mapping(building_file)
    places = _places(building, building_file)
    robot_start = _robot_start(building, building_file)
    _check_keys(scenario, _SCENARIO_KEYS, file)
    try:
        target = scenario["target"]
        _check_keys(target, _TARGET_KEYS, file)
        domain = Domain(
            name=folder.name,
            folder=folder,
            goal=scenario["goal"],
            robot_start=robot_start,
            initial_records=list(scenario["initial_records"]),
            target=Target(
                target["object"], target["goal_place"], target["at"], list(target["may_be_at"])
            ),
            placements=dict(scenario.get("placements") or {}),
            places=places,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(f"{file}: missing or malformed key {error}") from error
    if not isinstance(target["may_be_at"], list) or not target["may_be_at"]:
        raise Kr3Error(
            f"{file}: 'may_be_at': found {target['may_be_at']!r}, expected a list of places"
        )
    named = [domain.target.goal_place, domain.target.at, *domain.target.may_be_at]
    for place in [*named, *domain.placements.values()]:
        if place not in places:
            raise Kr3Error(
                f"{file}: '{place}' is no place of building.yaml, which has {', '.join(sorted(places))}"
            )
    return domain


def _check_keys(found: Mapping[str, Any], known: Collection[str], file: Path) -> None:
    """@throws Kr3Error  a key is none of those: misspelt, it would count as left out"""
    unknown = sorted(set(map(str, found)) - set(known))
    if unknown:
        raise Kr3Error(f"{file}: unknown key '{unknown[0]}'; known: {', '.join(known)}")


def _places(building: Mapping[str, Any], file: Path) -> Dict[str, Rectangle]:
    places: Dict[str, Rectangle] = {}
    try:
        for place in building["places"]:
            x_min, y_min, x_max, y_max = (float(value) for value in place["rectangle"])
            places[place["name"]] = Rectangle(x_min, y_min, x_max, y_max)
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(
            f"{file}: every entry of 'places' needs 'name' and 'rectangle' of four numbers"
        ) from error
    return places


def _robot_start(building: Mapping[str, Any], file: Path) -> List[float]:
    try:
        x, y, yaw = (float(value) for value in building["robot"]["start"])
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(f"{file}: expected 'robot: {{start: [x, y, yaw]}}'") from error
    return [x, y, yaw]
