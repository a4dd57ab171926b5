"""Attempts, and pictures of looks, from a recorded bag."""
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, Tuple

import rosbag
from kr3_msgs.msg import Status

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.bindings import Binding
from kr3_experiments.learning.counts import Attempt
from kr3_experiments.learning.laws import GroundAction, State
from kr3_experiments.learning.models_file import noisy_fluents
from kr3_experiments.learning.robot import Distances, cells_of, snapshot_of
from kr3_experiments.learning.session import Lesson
from kr3_experiments.learning.trials import Outcome, attempt_of
from kr3_experiments.learning.truth import components

_LOOKS = "looks/image/compressed"
_TRUTH_LATER_S = 1.6  # ground truth comes once a second, and after changes


@dataclass(frozen=True)
class Done:
    """One skill of a bag that had a result. Times in s."""

    binding: Binding
    action: GroundAction
    started_s: float
    ended_s: float
    result: Any  # kr3_msgs/ExecuteSkillResult


def _messages(path: Path, topics: List[str]) -> Iterator[Tuple[str, Any, float]]:
    """Messages with their names as the stack has them. @throws Kr3Error  no bag, or a broken one"""
    try:
        with rosbag.Bag(str(path)) as bag:
            wanted = [f"/{topic}" for topic in topics] + topics
            for topic, message, time in bag.read_messages(topics=wanted):
                yield topic.lstrip("/"), message, time.to_sec()
    except (OSError, rosbag.ROSBagException) as error:
        raise Kr3Error(f"{path}: {error}") from error


def skills_done(path: Path, lesson: Lesson) -> List[Done]:
    """Every skill with a result, as the low-level action that it does."""
    robot = lesson.truth().robot
    servers = {binding.server for binding in lesson.bindings.values()}
    topics = [f"{server}/{end}" for server in servers for end in ("goal", "result")]
    goals: Dict[str, Tuple[Any, float]] = {}
    done: List[Done] = []
    for topic, message, time_s in _messages(path, topics):
        server, _, end = topic.rpartition("/")
        if end == "goal":
            goals[message.goal_id.id] = (message.goal, time_s)
            continue
        goal = goals.pop(message.status.goal_id.id, None)
        if goal is None or message.result.status.code != Status.OK:
            continue
        for binding in lesson.bindings.values():
            if binding.server == server:
                action = binding.action_of(goal[0].skill, goal[0].arguments, robot)
                if action is not None:
                    done.append(Done(binding, action, goal[1], time_s, message.result))
                    break
    return done


def attempts_from_bag(path: Path, lesson: Lesson) -> Tuple[List[Attempt], int]:
    """The bag's attempts, with truth from its ground truth. @return attempts, and how many skills have no truth

    @throws Kr3Error  a bag without cells or ground truth
    """
    truth = lesson.truth()
    cells = None
    pose = None
    states: List[Tuple[float, State]] = []
    areas = []
    for topic, message, time_s in _messages(
        path, ["cells", "ground_truth/models", "ground_truth/pose", "pose"]
    ):
        if topic == "cells":
            cells, areas = message, cells_of(message)
        elif topic in ("ground_truth/pose", "pose"):  # the latter is the robot's own estimate
            pose = message
        elif topic == "ground_truth/models" and pose is not None and areas:
            states.append((time_s, truth.state(snapshot_of(message, pose, truth.robot), areas)))
    if cells is None or not states:
        raise Kr3Error(
            f"{path}: it holds no cells or no ground truth, so that nothing can be judged"
        )
    laws = lesson.laws(components(areas))
    distances = Distances(lesson.entries, lesson.keys)
    attempts: List[Attempt] = []
    skipped = 0
    for done in skills_done(path, lesson):
        before = _last(states, done.started_s)
        after = _first(states, done.ended_s)
        action = done.action
        if before is None or after is None or action.name not in lesson.entries:
            skipped += 1
            continue
        outcome = Outcome(
            done.result.outcome,
            tuple(done.result.observation),
            done.result.duration_s,
            distances.metres(action, before, cells),
        )
        attempts.append(
            attempt_of(
                laws, lesson.entries[action.name], done.binding, action, before, after, outcome
            )
        )
    return attempts, skipped


def _last(states: List[Tuple[float, State]], time_s: float) -> Optional[State]:
    return next((state for at, state in reversed(states) if at <= time_s), None)


def _first(states: List[Tuple[float, State]], time_s: float) -> Optional[State]:
    return next((state for at, state in states if time_s <= at <= time_s + _TRUTH_LATER_S), None)


def export_looks(path: Path, lesson: Lesson, folder: Path) -> int:
    """Write a picture of each look for a person to label, and what the robot said of it. @return how many"""
    folder.mkdir(parents=True, exist_ok=True)
    pictures = [(time_s, message) for _, message, time_s in _messages(path, [_LOOKS])]
    lines: List[str] = []
    for done in skills_done(path, lesson):
        asked = noisy_fluents(lesson.entries.get(done.action.name, {}))
        picture = next(
            (message for at, message in pictures if done.ended_s - 0.5 <= at <= done.ended_s + 3.0),
            None,
        )
        if not asked or picture is None:
            continue
        name = f"{len(lines):05d}.jpg"
        (folder / name).write_bytes(picture.data)
        lines.append(
            json.dumps(
                {
                    "image": name,
                    "action": done.action.name,
                    "arguments": list(done.action.arguments),
                    "outcome": done.result.outcome,
                    "duration_s": done.result.duration_s,
                }
            )
        )
    (folder / "looks.jsonl").write_text("".join(line + "\n" for line in lines), encoding="utf-8")
    (folder / "README.txt").write_text(
        "One picture a look. Label, with a box each, the objects that are in the place looked at (looks.jsonl says\n"
        "which place and object the robot asked about), and save the labels here as COCO, or as labels.json:\n"
        '{"images": [{"image": "00000.jpg", "objects": [{"name": "NAME", "box": [x, y, width, height]}]}]}\n'
        "Every image needs an entry; in one that shows none of what was asked about it is not so.\n",
        encoding="utf-8",
    )
    return len(lines)
