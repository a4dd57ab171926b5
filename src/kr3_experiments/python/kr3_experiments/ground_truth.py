"""Whether a mission succeeded in truth. Knows no ROS: takes what `ground_truth/models` says as plain values."""
from dataclasses import dataclass
from typing import Mapping, Optional, Tuple

from kr3_experiments.domain import Domain

Position = Tuple[float, float, float]  # m, world frame


@dataclass(frozen=True)
class Verdict:
    """`reason` is for people, also when it succeeded."""

    success: bool
    reason: str


def check_fetched(domain: Domain, positions: Mapping[str, Position], held: str) -> Verdict:
    """The target has to lie in the goal place, let go.

    @param positions  of all movable bodies; @param held  name of what is in the gripper, empty if nothing
    """
    target = domain.target
    position: Optional[Position] = positions.get(target.object)
    if position is None:
        return Verdict(False, f"{target.object} is not among the bodies of the simulated world")
    x, y, _ = position
    where = domain.place_at(x, y) or "no place"
    if held == target.object:
        return Verdict(False, f"the robot still holds {target.object}, in {where}")
    at = f"{target.object} is at ({x:.2f}, {y:.2f}) m, in {where}"
    if not domain.places[target.goal_place].contains(x, y):
        return Verdict(False, f"{at}, not in {target.goal_place}")
    return Verdict(True, at)
