"""Which picture is kept of a search, whatever order its messages come in."""
from typing import Any, List, Sequence

import numpy as np
import pytest
import rospy
from cv_bridge import CvBridge
from kr3_msgs.msg import (
    Detection,
    DetectionArray,
    ExecuteSkillActionGoal,
    ExecuteSkillActionResult,
    Sighting,
)

from kr3_experiments import mission
from kr3_experiments.mission import LookCollector


class Connection:
    """Stands for a publisher or a subscriber without a master."""

    def __init__(self, *_arguments: Any, **_options: Any) -> None:
        self.sent: List[Any] = []

    def publish(self, message: Any) -> None:
        self.sent.append(message)

    def unregister(self) -> None:
        pass


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> LookCollector:
    monkeypatch.setattr(mission.rospy, "Subscriber", Connection)
    monkeypatch.setattr(mission.rospy, "Publisher", Connection)
    return LookCollector()


def search_goal(target: str) -> ExecuteSkillActionGoal:
    message = ExecuteSkillActionGoal()
    message.goal.arguments = [target]
    return message


def search_result(outcome: str, sightings: Sequence[str] = ()) -> ExecuteSkillActionResult:
    message = ExecuteSkillActionResult()
    message.result.outcome = outcome
    message.result.sightings = [Sighting(literal=literal) for literal in sightings]
    return message


def show(looks: LookCollector, at_s: float, shade: int, probability: float) -> None:
    """A frame of one shade, in which the object sought has this probability."""
    found = DetectionArray(detections=[Detection(name="book", probability=probability)])
    found.header.stamp = rospy.Time.from_sec(at_s)
    picture = CvBridge().cv2_to_imgmsg(np.full((2, 3, 3), shade, np.uint8), "bgr8")
    picture.header.stamp = found.header.stamp
    looks._on_detections(found)
    looks._on_image(picture)


def test_the_picture_with_the_object_is_kept(looks: LookCollector) -> None:
    looks._on_goal(search_goal("book"))
    show(looks, 1.0, 10, 0.2)
    show(looks, 2.0, 20, 0.9)
    show(looks, 3.0, 30, 0.1)
    looks._on_result(search_result("found"))
    assert looks.found_image is not None
    assert int(looks.found_image[0, 0, 0]) == 20
    assert looks.found_what == ["book"]


def test_a_find_before_the_first_picture_gets_the_next_one(looks: LookCollector) -> None:
    looks._on_goal(search_goal("book"))
    looks._on_result(search_result("not_found", ["at(book) = shelf"]))
    assert looks.found_image is None
    show(looks, 1.0, 40, 0.9)
    assert looks.found_image is not None
    show(looks, 2.0, 50, 0.9)
    assert int(looks.found_image[0, 0, 0]) == 40


def test_a_late_picture_of_a_failed_search_is_no_find(looks: LookCollector) -> None:
    looks._on_goal(search_goal("book"))
    looks._on_result(search_result("not_found", ["at(mug) = shelf"]))
    show(looks, 1.0, 40, 0.3)
    assert looks.found_image is None
    looks._on_goal(search_goal("book"))
    show(looks, 2.0, 60, 0.8)
    assert looks.found_image is None
    looks._on_result(search_result("found"))
    assert int(looks.found_image[0, 0, 0]) == 60
