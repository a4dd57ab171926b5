"""Looks that a person labelled: the labels are the truth of what the robot said."""
import json
from pathlib import Path
from typing import Any, Dict, List, Set

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.counts import Attempt, Observed
from kr3_experiments.learning.models_file import noisy_fluents
from kr3_experiments.learning.session import Lesson


def attempts_from_labels(folder: Path, lesson: Lesson) -> List[Attempt]:
    """The looks of a folder that `--export-looks` wrote and a person labelled.

    @throws Kr3Error  no labels, or labels or looks that are malformed; the message names file and entry
    """
    seen = labelled_objects(folder)
    looks = folder / "looks.jsonl"
    laws = lesson.laws({})
    attempts = []
    for number, line in enumerate(_text(looks).splitlines(), 1):
        try:
            look = json.loads(line)
            name, arguments = str(look["action"]), tuple(str(item) for item in look["arguments"])
            image, outcome = str(look["image"]), str(look["outcome"])
            duration_s = float(look["duration_s"])
        except (ValueError, KeyError, TypeError) as error:
            raise Kr3Error(f"{looks}:{number}: not a look: {error}") from error
        if name not in lesson.bindings or outcome not in lesson.bindings[name].outcomes:
            raise Kr3Error(f"{looks}:{number}: the bindings have no {name} with outcome {outcome}")
        if image not in seen:
            raise Kr3Error(f"{folder}: the labels have no entry for {image} (looks.jsonl:{number})")
        answers = list(lesson.bindings[name].outcomes[outcome])
        observed = []
        for law in laws.observations:
            if law.action.name != name or not answers:
                continue
            answer = answers.pop(0)
            if law.fluent.name in noisy_fluents(lesson.entries[name]):
                values = dict(zip(law.action.arguments, arguments))
                asked = {values.get(item, item) for item in law.fluent.arguments}
                observed.append(Observed(law.fluent.name, asked <= seen[image], answer == "true"))
        attempts.append(Attempt(name, arguments, True, "", tuple(observed), duration_s))
    return attempts


def labelled_objects(folder: Path) -> Dict[str, Set[str]]:
    """Names in each image, from labels.json or a COCO file. @throws Kr3Error"""
    ours = folder / "labels.json"
    if ours.exists():
        return _ours(ours, _json(ours))
    for path in sorted(folder.glob("*.json")):
        content = _json(path)
        if isinstance(content, dict) and "annotations" in content:
            return _coco(path, content)
    raise Kr3Error(f"{folder}: there are no labels, expected labels.json or a COCO file")


def _ours(path: Path, content: Any) -> Dict[str, Set[str]]:
    result: Dict[str, Set[str]] = {}
    if not isinstance(content, dict) or not isinstance(content.get("images"), list):
        raise Kr3Error(f"{path}: expected a list named 'images'")
    for number, entry in enumerate(content["images"]):
        try:
            names = set()
            for thing, item in enumerate(entry["objects"]):
                box = [float(value) for value in item["box"]]
                if len(box) != 4 or not (box[2] > 0 and box[3] > 0):
                    raise Kr3Error(
                        f"{path}: image {number}: object {thing}: the box {item['box']} has no area"
                    )
                names.add(str(item["name"]))
            result[str(entry["image"])] = names
        except (KeyError, TypeError, ValueError) as error:
            raise Kr3Error(f"{path}: image {number}: missing or malformed {error}") from error
    return result


def _coco(path: Path, content: Dict[str, Any]) -> Dict[str, Set[str]]:
    try:
        categories = {item["id"]: str(item["name"]) for item in content["categories"]}
        images = {item["id"]: Path(str(item["file_name"])).name for item in content["images"]}
    except (KeyError, TypeError) as error:
        raise Kr3Error(f"{path}: missing or malformed {error}") from error
    result: Dict[str, Set[str]] = {name: set() for name in images.values()}
    for number, item in enumerate(content["annotations"]):
        try:
            result[images[item["image_id"]]].add(categories[item["category_id"]])
        except (KeyError, TypeError) as error:
            raise Kr3Error(f"{path}: annotation {number}: unknown or missing {error}") from error
    return result


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise Kr3Error(f"{path}: {error.strerror}") from error


def _json(path: Path) -> Any:
    try:
        return json.loads(_text(path))
    except ValueError as error:
        raise Kr3Error(f"{path}: not JSON: {error}") from error
