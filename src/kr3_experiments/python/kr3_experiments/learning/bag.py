"""Attempts, and pictures of looks, from a recorded bag."""
import bisect
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

import rosbag
from kr3_msgs.msg import Status

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.bindings import Binding
from kr3_experiments.learning.counts import Attempt
from kr3_experiments.learning.laws import GroundAction, State
from kr3_experiments.learning.models_file import noisy_fluents
from kr3_experiments.learning.robot import Distances, cells_of, snapshot_of
from kr3_experiments.learning.session import Lesson
from kr3_experiments.learning.trials import Outcome, attempt_of, moved
from kr3_experiments.learning.truth import components

_LOOKS = "looks/image/compressed"
_PICTURE_EARLIER_S, _PICTURE_LATER_S = 0.5, 3.0  # than the end of its look
_TRUTH_LATER_S = 1.6  # ground truth comes once a second, and after changes


Timed = List[Tuple[float, Any]]  # messages with their times in s, in order


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
    cells = None
    poses: Timed = []  # of the ground truth, or else the robot's own estimate
    estimates: Timed = []
    models: Timed = []
    for topic, message, time_s in _messages(
        path, ["cells", "ground_truth/models", "ground_truth/pose", "pose"]
    ):
        if topic == "cells":
            cells = message
        else:
            kept = {"ground_truth/models": models, "ground_truth/pose": poses, "pose": estimates}
            kept[topic].append((time_s, message))
    poses = poses or estimates
    if cells is None or not models or not poses:
        raise Kr3Error(
            f"{path}: it holds no cells or no ground truth, so that nothing can be judged"
        )
    areas = cells_of(cells)
    truth = lesson.truth()

    def state(find: Callable[[Timed, float], Any], time_s: float) -> Optional[State]:
        """Bodies are reported now and then, the robot all the time: it may drive on before the next report."""
        bodies, pose = find(models, time_s), find(poses, time_s)
        if bodies is None or pose is None:
            return None
        return truth.state(snapshot_of(bodies, pose, truth.robot), areas)

    laws = lesson.laws(components(areas))
    distances = Distances(lesson.entries, lesson.keys)
    attempts: List[Attempt] = []
    skipped = 0
    visit = 1
    for done in skills_done(path, lesson):
        before = state(_last, done.started_s)
        after = state(_first, done.ended_s)
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
        attempt = attempt_of(
            laws, lesson.entries[action.name], done.binding, action, before, after, outcome
        )
        attempts.append(replace(attempt, visit=visit))
        visit += moved(before, after)
    return attempts, skipped


def _last(messages: Timed, time_s: float) -> Any:
    """The last message up to a time; None: there is none."""
    at = bisect.bisect_right(messages, time_s, key=lambda entry: entry[0])
    return messages[at - 1][1] if at > 0 else None


def _first(messages: Timed, time_s: float) -> Any:
    """The first message from a time on; None: there is none soon enough."""
    at = bisect.bisect_left(messages, time_s, key=lambda entry: entry[0])
    if at == len(messages) or messages[at][0] > time_s + _TRUTH_LATER_S:
        return None
    return messages[at][1]


def export_looks(path: Path, lesson: Lesson, folder: Path) -> int:
    """Write a picture of each look for a person to label, and what the robot said of it. @return how many"""
    folder.mkdir(parents=True, exist_ok=True)
    pictures = [(time_s, message) for _, message, time_s in _messages(path, [_LOOKS])]
    lines: List[str] = []
    for done in skills_done(path, lesson):
        asked = noisy_fluents(lesson.entries.get(done.action.name, {}))
        near = [
            entry
            for entry in pictures
            if done.ended_s - _PICTURE_EARLIER_S <= entry[0] <= done.ended_s + _PICTURE_LATER_S
        ]
        if not asked or not near:
            continue
        chosen = min(near, key=lambda entry: abs(entry[0] - done.ended_s))
        pictures.remove(chosen)  # of one look only: the next one may have ended soon after
        picture = chosen[1]
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
