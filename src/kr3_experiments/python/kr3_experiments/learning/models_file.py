"""Writes models.yaml with what was learned: learned numbers in the place of hand-written ones."""
import datetime
import os
import re
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import yaml

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.counts import PRIOR, Attempt, Counts, Interval, Sensor, agree, share
from kr3_experiments.learning.laws import LowLevel
from kr3_experiments.yaml_file import read_mapping

Models = Dict[str, Any]
MIN_CLASS_TRIALS = (
    20  # of each truth, or of a label's action, before a class gets numbers of its own
)


def load_models(path: Path) -> Models:
    """@throws Kr3Error  no file, or not a models file"""
    expected = "expected a map with 'actions', as docs/refinement.md says"
    content = read_mapping(path, expected)
    if not isinstance(content.get("actions"), dict):
        raise Kr3Error(f"{path}: {expected}")
    return content


def action_name(key: str, path: Path) -> Tuple[str, List[str]]:
    """Name and parameters of "name(A, B)". @throws Kr3Error"""
    match = re.fullmatch(r"\s*(\w+)\s*(?:\(([^()]*)\))?\s*", key)
    if match is None:
        raise Kr3Error(f"{path}: found the action '{key}', expected name(P1, P2)")
    return match.group(1), [
        item.strip() for item in (match.group(2) or "").split(",") if item.strip()
    ]


def noisy_fluents(entry: Mapping[str, Any]) -> List[str]:
    """The fluents whose observation is to be learned: those that are not exact."""
    return [name for name, model in (entry.get("observations") or {}).items() if model != "exact"]


def learned(models: Models, counts: Mapping[str, Counts], path: Path) -> Models:
    """The models with the numbers that were counted; what was not tried stays as it is, and as it is marked."""
    result: Models = {**models, "actions": {}}
    for key, entry in models["actions"].items():
        name, _ = action_name(key, path)
        result["actions"][key] = (
            _learned_entry(entry, counts[name]) if name in counts else dict(entry)
        )
    return result


def _learned_entry(entry: Mapping[str, Any], counts: Counts) -> Dict[str, Any]:
    result = dict(entry)
    if "outcomes" in entry and sum(counts.outcomes.values()) > 0:
        result["outcomes"] = outcomes_of(counts.outcomes)
    if entry.get("observations"):
        result["observations"] = {
            fluent: (
                sensor_of(counts.sensors[fluent])
                if model != "exact" and fluent in counts.sensors and usable(counts.sensors[fluent])
                else model
            )
            for fluent, model in entry["observations"].items()
        }
    if entry.get("cost") is not None and len(counts.durations.carried_out) >= 2:
        result["cost"] = _cost_of(entry["cost"], counts)
    return result


def usable(sensor: Sensor) -> bool:
    """Whether the sensor was tried where it is so and where it is not, and says yes more often where it is."""
    yes = sensor.true_positive + sensor.false_negative
    no = sensor.false_positive + sensor.true_negative
    if sensor.tells_value or yes == 0 or no == 0:
        return yes > 0 and sensor.tells_value
    return share(sensor.true_positive, yes).mean > share(sensor.false_positive, no).mean


def outcomes_of(counts: Mapping[str, int]) -> Dict[str, Any]:
    """Dirichlet's mean, by label; the last digit goes to the likeliest label, so that they sum to 1."""
    total = sum(counts.values())
    means = {
        label: round(share(number, total, len(counts)).mean, 4) for label, number in counts.items()
    }
    likeliest = max(means, key=lambda label: means[label])
    means[likeliest] = round(1.0 - sum(p for label, p in means.items() if label != likeliest), 4)
    return {"probabilities": means, "counts": dict(counts), "prior": PRIOR, "source": "learned"}


def sensor_of(sensor: Sensor) -> Dict[str, Any]:
    """Beta's means."""
    positives = sensor.true_positive + sensor.false_negative
    true_positive = round(share(sensor.true_positive, positives).mean, 4)
    if sensor.tells_value:
        counts = {"right": sensor.true_positive, "wrong": sensor.false_negative}
        return {
            "true_positive": true_positive,
            "counts": counts,
            "prior": PRIOR,
            "source": "learned",
        }
    negatives = sensor.false_positive + sensor.true_negative
    return {
        "true_positive": true_positive,
        "false_positive": round(share(sensor.false_positive, negatives).mean, 4),
        "counts": {
            "true_positive": sensor.true_positive,
            "false_negative": sensor.false_negative,
            "false_positive": sensor.false_positive,
            "true_negative": sensor.true_negative,
        },
        "prior": PRIOR,
        "source": "learned",
    }


def _cost_of(cost: Mapping[str, Any], counts: Counts) -> Dict[str, Any]:
    base, per_metre, deviation = counts.durations.line("distance" in cost)
    result = dict(cost)
    result["base_s"] = round(base, 2)
    if "distance" in cost:
        result["per_metre_s"] = round(per_metre, 3)
    in_vain = counts.durations.impossible
    if in_vain:
        result["impossible_s"] = round(sum(in_vain) / len(in_vain), 2)
    result["stddev_s"] = round(deviation, 2)
    result["counts"] = {
        "carried_out": len(counts.durations.carried_out),
        "impossible": len(in_vain),
    }
    result["source"] = "learned"
    return result


def with_classes(models: Models, attempts: Sequence[Attempt], laws: LowLevel, path: Path) -> Models:
    """Adds numbers of their own for classes of arguments that were tried often enough: the sorts that are parts of a
    parameter's sort."""
    result = {**models, "actions": dict(models["actions"])}
    for key, entry in models["actions"].items():
        name, parameters = action_name(key, path)
        mine = [attempt for attempt in attempts if attempt.action == name]
        classes: List[Dict[str, Any]] = []
        for index, sort in enumerate(laws.parameters(name)):
            for part in _parts(sort, laws):
                counts = Counts()
                for attempt in mine:
                    if attempt.arguments[index] in laws.sorts[part]:
                        counts.add(attempt, laws.labels(name))
                numbers = _class_numbers(entry, counts)
                if numbers:
                    classes.append({"for": {parameters[index]: part}, **numbers})
        if classes:
            result["actions"][key] = {**entry, "classes": classes}
    return result


def _parts(sort: str, laws: LowLevel) -> List[str]:
    """The largest sorts that are proper parts of a sort, none overlapping another."""
    whole = set(laws.sorts.get(sort, []))
    inside = [name for name, elements in laws.sorts.items() if elements and set(elements) < whole]
    inside.sort(key=lambda name: (-len(laws.sorts[name]), name))
    chosen: List[str] = []
    for name in inside:
        if all(set(laws.sorts[name]).isdisjoint(laws.sorts[other]) for other in chosen):
            chosen.append(name)
    return chosen


def _class_numbers(entry: Mapping[str, Any], counts: Counts) -> Dict[str, Any]:
    numbers: Dict[str, Any] = {}
    if "outcomes" in entry and sum(counts.outcomes.values()) >= MIN_CLASS_TRIALS:
        numbers["outcomes"] = outcomes_of(counts.outcomes)
    sensors = {}
    for fluent in noisy_fluents(entry):
        sensor = counts.sensors.get(fluent)
        if sensor is None:
            continue
        yes = sensor.true_positive + sensor.false_negative
        no = sensor.false_positive + sensor.true_negative
        if min(yes, yes if sensor.tells_value else no) >= MIN_CLASS_TRIALS:
            sensors[fluent] = sensor_of(sensor)
    if sensors:
        numbers["observations"] = sensors
    return numbers


def write_models(models: Models, path: Path, how: Sequence[str]) -> None:
    """Write a models file whole or not at all.

    @param how  lines for its head
    @throws Kr3Error  it cannot be written
    """
    head = [
        "The numbers of the low level, learned by `./kr3 learn`; see docs/refinement.md. Times in seconds,",
        "probabilities in [0, 1]; counts are the sample sizes, and the numbers the means of their posteriors.",
        "What was not tried is hand-written, and marked so.",
        *how,
        f"Written on {datetime.date.today().isoformat()}.",
    ]
    text = "".join(f"# {line}\n" for line in head) + "\n" + _yaml(models)
    temporary = path.with_name(f".{path.name}.part")
    try:
        temporary.write_text(text, encoding="utf-8")
        os.replace(temporary, path)
    except OSError as error:
        raise Kr3Error(f"{path}: {error.strerror}") from error


def _yaml(models: Models) -> str:
    class Dumper(yaml.SafeDumper):
        """Small maps on one line."""

    def represent(dumper: yaml.SafeDumper, value: Dict[str, Any]) -> yaml.Node:
        small = (
            all(
                not isinstance(item, (dict, list))
                or (
                    isinstance(item, dict)
                    and len(item) <= 4
                    and not any(isinstance(part, (dict, list)) for part in item.values())
                )
                for item in value.values()
            )
            and len(value) <= 9
        )
        return dumper.represent_mapping("tag:yaml.org,2002:map", value.items(), flow_style=small)

    Dumper.add_representer(dict, represent)
    return yaml.dump(models, Dumper=Dumper, sort_keys=False, width=110)


def table(counts: Mapping[str, Counts]) -> List[str]:
    """Lines for people: every learned number with its sample size and 95 % interval."""
    lines = []
    for name, counted in counts.items():
        total = sum(counted.outcomes.values())
        for label, number in counted.outcomes.items():
            interval = counted.interval(label) if total else None
            lines.append(_row(f"{name}: {label}", number, total, interval))
        for fluent, sensor in counted.sensors.items():
            positives = sensor.true_positive + sensor.false_negative
            negatives = sensor.false_positive + sensor.true_negative
            what = "right" if sensor.tells_value else "yes where it is so"
            interval = sensor.interval(True)
            lines.append(
                _row(f"{name}: {fluent}, {what}", sensor.true_positive, positives, interval)
            )
            if not sensor.tells_value:
                what, interval = "yes where it is not", sensor.interval(False)
                lines.append(
                    _row(f"{name}: {fluent}, {what}", sensor.false_positive, negatives, interval)
                )
            if positives > 0 and negatives > 0 and not usable(sensor):
                lines.append(f"{name}: {fluent} says no more than chance: its numbers stay")
        durations = counted.durations
        if durations.carried_out:
            base, slope, deviation = durations.line(any(x > 0 for x, _ in durations.carried_out))
            metre = f" + {slope:.2f} s/m" if slope > 0 else ""
            size = f"deviation {deviation:.2f}, n = {len(durations.carried_out)}"
            lines.append(f"{name + ': seconds':<44} {base:.2f}{metre} ({size})")
        if counted.unexplained:
            lines.append(
                f"{name}: {counted.unexplained} results are none of its outcomes, not counted"
            )
    return lines


def _row(what: str, number: int, total: int, interval: Optional[Interval]) -> str:
    if total == 0 or interval is None:
        return f"{what:<44} not tried"
    return f"{what:<44} {interval.mean:.3f} [{interval.low:.3f}, {interval.high:.3f}]  ({number} of {total})"


def agreement(
    first: Mapping[str, Counts], second: Mapping[str, Counts]
) -> Tuple[List[str], List[str]]:
    """Compare what two training phases learned. @return lines for people, and what disagrees"""
    lines, apart = [], []
    for name in [name for name in first if name in second]:
        ours, theirs = first[name].intervals(), second[name].intervals()
        for what in [what for what in ours if what in theirs]:
            (one, n), (other, m) = ours[what], theirs[what]
            same = agree(one, other)
            if not same:
                apart.append(f"{name}: {what}")
            lines.append(
                f"{name + ': ' + what:<44} {one.mean:.3f} [{one.low:.3f}, {one.high:.3f}] of {n}"
                f" and {other.mean:.3f} [{other.low:.3f}, {other.high:.3f}] of {m}:"
                f" {'agree' if same else 'DISAGREE'}"
            )
    return lines, apart
