"""Learning from a recorded bag, and from a person's labels of its looks."""
import json
from pathlib import Path
from typing import List, Tuple

import genpy
import pytest
import rosbag
from geometry_msgs.msg import PoseWithCovarianceStamped
from kr3_msgs.msg import (
    Cell,
    CellArray,
    ExecuteSkillActionGoal,
    ExecuteSkillActionResult,
    ModelPose,
    ModelStates,
    Status,
)
from sensor_msgs.msg import CompressedImage

from kr3_experiments.cli import main
from kr3_experiments.domain import repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.bag import attempts_from_bag, export_looks
from kr3_experiments.learning.counts import count
from kr3_experiments.learning.labels import attempts_from_labels
from kr3_experiments.learning.laws import GroundAction
from kr3_experiments.learning.session import Lesson, load_lesson

# (action, arguments, asked at s, answered at s, outcome): the robot is in office_c0, the book too, the mug beside it
SKILLS: List[Tuple[str, Tuple[str, ...], float, float, str]] = [
    ("search", ("rob1", "office_c0", "tb1"), 2.0, 5.0, "found"),
    ("search", ("rob1", "office_c0", "mug1"), 5.1, 5.4, "found"),
    ("move", ("rob1", "office_c1"), 6.0, 8.0, "reached"),
    ("move", ("rob1", "office_c0"), 8.02, 10.0, "reached"),
    ("search", ("rob1", "office_c0", "tb1"), 10.2, 11.0, "not_found"),
]
PICTURE = b"\xff\xd8 a picture"


def robot_x(time_s: float) -> float:
    """1 m in office_c0, 3 m in office_c1; there only from 7.5 s to 8.3 s."""
    return 3.0 if 7.5 <= time_s <= 8.3 else 1.0


def events(lesson: Lesson):
    """(time, topic, message) of a recording."""
    cells = CellArray(travel_distance=[0.0, 2.0, 2.0, 0.0])
    for i in (0, 1):
        cell = Cell(name=f"office_c{i}", room="office", size_x=2.0, size_y=2.0)
        cell.center.x, cell.center.y = 1.0 + 2.0 * i, 1.0
        cells.cells.append(cell)
    yield 0.0, "/cells", cells
    for tick in range(125):
        pose = PoseWithCovarianceStamped()
        pose.pose.pose.position.x, pose.pose.pose.position.y = robot_x(tick / 10), 1.0
        yield tick / 10, "/pose", pose
    for second in range(13):
        models = ModelStates()
        for name, x in (("tb1", 0.5), ("mug1", 3.5)):
            model = ModelPose(name=name)
            model.pose.position.x, model.pose.position.y = x, 1.0
            models.models.append(model)
        yield second + 0.9, "/ground_truth/models", models
    for number, (name, arguments, asked, answered, outcome) in enumerate(SKILLS):
        binding = lesson.bindings[name]
        goal = ExecuteSkillActionGoal()
        goal.goal_id.id = str(number)
        goal.goal.skill = binding.skill
        goal.goal.arguments = binding.skill_arguments(GroundAction(name, arguments), {})
        yield asked, f"/{binding.server}/goal", goal
        result = ExecuteSkillActionResult()
        result.status.goal_id.id = str(number)
        result.result.status.code = Status.OK
        result.result.outcome = outcome
        result.result.observation = [arguments[1]] if name == "move" else []
        result.result.duration_s = answered - asked
        yield answered, f"/{binding.server}/result", result
        if name == "search":
            yield answered + 0.05, "/looks/image/compressed", CompressedImage(
                data=PICTURE + bytes([number])
            )


@pytest.fixture(name="lesson")
def _lesson() -> Lesson:
    return load_lesson(repository_root() / "domains" / "office")


def recorded(lesson: Lesson, path: Path, without: str = "") -> Path:
    with rosbag.Bag(str(path), "w") as bag:
        for time_s, topic, message in sorted(events(lesson), key=lambda event: event[0]):
            if not without or not topic.startswith(without):
                bag.write(topic, message, genpy.Time.from_sec(time_s + 1.0))
    return path


def test_a_bags_skills_are_judged_by_its_ground_truth(lesson: Lesson, tmp_path: Path) -> None:
    attempts, skipped = attempts_from_bag(recorded(lesson, tmp_path / "a.bag"), lesson)
    assert skipped == 0
    assert [attempt.action for attempt in attempts] == [skill[0] for skill in SKILLS]
    counts = count(attempts, {"move": ["reached", "slipped"]})
    sensor = counts["search"].sensors["loc"]
    assert (sensor.true_positive, sensor.false_negative, sensor.false_positive) == (1, 1, 1)
    # The robot drives on 20 ms after it arrived, long before bodies are reported again.
    assert counts["move"].outcomes == {"reached": 2, "slipped": 0}
    assert [attempt.metres for attempt in attempts if attempt.action == "move"] == [2.0, 2.0]
    assert [attempt.visit for attempt in attempts] == [1, 1, 1, 2, 3]


def test_looks_that_a_person_labels_count_as_the_ground_truth_does(
    lesson: Lesson, tmp_path: Path
) -> None:
    looks = tmp_path / "looks"
    bag = recorded(lesson, tmp_path / "a.bag")
    assert main(["learn", "office", "--bag", str(bag), "--export-looks", str(looks)]) == 0
    lines = [json.loads(line) for line in (looks / "looks.jsonl").read_text().splitlines()]
    assert [line["arguments"][2] for line in lines] == ["tb1", "mug1", "tb1"]
    pictures = [(looks / line["image"]).read_bytes() for line in lines]
    # Each look has its own picture, those that ended 0.4 s apart too.
    assert pictures == [PICTURE + bytes([number]) for number in (0, 1, 4)]
    # The person sees the book in the cell of both looks that asked for it, and no mug there.
    images = [
        {"image": line["image"], "objects": [{"name": "tb1", "box": [0, 0, 9, 9]}]}
        for line in lines
    ]
    (looks / "labels.json").write_text(json.dumps({"images": images}))
    labelled = count(attempts_from_labels(looks, lesson), {})["search"].sensors["loc"]
    known = count(attempts_from_bag(bag, lesson)[0], {})["search"].sensors["loc"]
    for name in ("true_positive", "false_negative", "false_positive", "true_negative"):
        assert getattr(labelled, name) == getattr(known, name)
    output = tmp_path / "models.yaml"
    assert main(["learn", "office", "--labels", str(looks), "--output", str(output)]) == 0
    assert "From a person's labels, 3 looks." in output.read_text()


@pytest.mark.parametrize("missing", ["/cells", "/ground_truth", "/pose"])
def test_a_bag_that_tells_nothing_is_refused(lesson: Lesson, tmp_path: Path, missing: str) -> None:
    bag = recorded(lesson, tmp_path / "a.bag", without=missing)
    with pytest.raises(Kr3Error, match="a.bag: it holds no cells or no ground truth"):
        attempts_from_bag(bag, lesson)


def test_what_is_no_bag_is_named(lesson: Lesson, tmp_path: Path) -> None:
    path = tmp_path / "no.bag"
    path.write_text("nothing of the kind")
    for read in (attempts_from_bag, lambda bag, of: export_looks(bag, of, tmp_path / "looks")):
        with pytest.raises(Kr3Error, match="no.bag"):
            read(path, lesson)
    with pytest.raises(Kr3Error, match="nowhere.bag"):
        attempts_from_bag(tmp_path / "nowhere.bag", lesson)
