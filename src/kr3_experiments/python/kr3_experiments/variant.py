"""Missions other than the scenario's in the same building: another start, another place to bring the object to."""
import math
import random
import re
from dataclasses import dataclass, replace
from typing import Any, List, Mapping

from kr3_experiments.domain import Domain
from kr3_experiments.errors import Kr3Error
from kr3_experiments.yaml_file import read_mapping

_CLEARANCE_M = 0.55  # from where the robot starts to walls and furniture
_MOST_TRIES = 10000


@dataclass(frozen=True)
class _Furniture:
    """A box on the floor, in the map frame."""

    place: str
    x: float  # m, of its centre
    y: float
    yaw: float  # rad
    length: float  # m, along its own x axis
    width: float

    def distance(self, x: float, y: float) -> float:
        """From a point to the box, m; 0 inside."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        along = cos * (x - self.x) + sin * (y - self.y)
        across = cos * (y - self.y) - sin * (x - self.x)
        return math.hypot(
            max(abs(along) - self.length / 2.0, 0.0), max(abs(across) - self.width / 2.0, 0.0)
        )


def with_goal_place(domain: Domain, place: str) -> Domain:
    """The same mission, but the object is wanted elsewhere.

    @throws Kr3Error  unknown place, or the goal does not say where the target has to be
    """
    domain.require_place(place)
    fluent, old = domain.target_fluent(), domain.target.goal_place
    goal = re.sub(
        rf"({re.escape(fluent)}\s*=\s*){re.escape(old)}\b", rf"\g<1>{place}", domain.goal, count=1
    )
    return replace(domain, goal=goal, target=replace(domain.target, goal_place=place))


def with_start(domain: Domain, place: str, seed: int) -> Domain:
    """The same mission, but the robot starts on free floor of `place`, and knows it.

    @param seed  of the pose
    @throws Kr3Error  unknown place; no free floor; no single record says where the robot starts
    """
    domain.require_place(place)
    before = domain.place_at(*domain.robot_start[:2])
    pattern = re.compile(rf"(\s*\w+\([^()]*\)\s*=\s*){before}\s*")
    records = [dict(record) for record in domain.initial_records]
    found = [
        (record, match)
        for record in records
        for match in [pattern.fullmatch(str(record.get("statement", "")))]
        if record.get("value", True) and match and domain.target.object not in match.group(1)
    ]
    if len(found) != 1:
        raise Kr3Error(
            f"{domain.scenario_file}: {len(found)} of 'initial_records' say that something is in {before},"
            " where the robot starts by building.yaml; expected one, about the robot"
        )
    record, match = found[0]
    record["statement"] = f"{match.group(1).strip()} {place}"
    return replace(
        domain, initial_records=records, robot_start=_free_pose(domain, place, random.Random(seed))
    )


def furnished_places(domain: Domain) -> List[str]:
    """Where objects can lie: places with furniture, by name. @throws Kr3Error  building.yaml is malformed"""
    return sorted({item.place for item in _furniture(domain)} & set(domain.places))


def _free_pose(domain: Domain, place: str, draws: random.Random) -> List[float]:
    """x, y in m, yaw in rad."""
    area = domain.places[place]
    furniture = _furniture(domain)
    for _ in range(_MOST_TRIES):
        x = draws.uniform(area.x_min, area.x_max)
        y = draws.uniform(area.y_min, area.y_max)
        to_walls = min(x - area.x_min, area.x_max - x, y - area.y_min, area.y_max - y)
        if min([to_walls, *(item.distance(x, y) for item in furniture)]) >= _CLEARANCE_M:
            return [round(x, 3), round(y, 3), round(draws.uniform(-math.pi, math.pi), 3)]
    raise Kr3Error(f"{domain.folder / 'building.yaml'}: no free floor for the robot in {place}")


def _furniture(domain: Domain) -> List[_Furniture]:
    file = domain.folder / "building.yaml"
    building: Mapping[str, Any] = read_mapping(file)
    items = []
    try:
        for item in building.get("furniture") or []:
            x, y, yaw = (float(value) for value in item["pose"])
            length, width, _ = (float(value) for value in item["size"])
            items.append(_Furniture(item["place"], x, y, yaw, length, width))
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(
            f"{file}: every entry of 'furniture' needs 'place', 'pose' and 'size' of three numbers"
        ) from error
    return items
