"""The inputs of missions in a bag, as lines for kr3_replay."""
import json
from pathlib import Path
from typing import Any, List

import rosbag

from kr3_experiments.errors import Kr3Error

_KINDS = (
    "DOMAIN",
    "MISSION",
    "SKILL_RESULT",
    "TOLD",
    "CANCEL",
    "DECISION",
)  # kr3_msgs/MissionInput


def open_bag(file: Path) -> rosbag.Bag:
    """@throws Kr3Error  no such file, or it is not a complete bag"""
    try:
        return rosbag.Bag(str(file))
    except OSError as error:
        raise Kr3Error(f"{file}: {error.strerror or error}") from error
    except rosbag.ROSBagUnindexedException as error:
        raise Kr3Error(
            f"{file} was not closed properly: `rosbag reindex {file}` makes it readable"
        ) from error
    except rosbag.ROSBagException as error:
        raise Kr3Error(f"{file} is not a bag: {error}") from error


def input_lines(file: Path) -> List[str]:
    """One JSON object for each kr3_msgs/MissionInput, in the bag's order.

    @throws Kr3Error  as open_bag; the bag holds no inputs, or one is malformed
    """
    lines = []
    with open_bag(file) as bag:
        topics = bag.get_type_and_topic_info().topics
        names = [name for name, info in topics.items() if info.msg_type == "kr3_msgs/MissionInput"]
        if not names:
            raise Kr3Error(
                f"{file} holds no inputs of a mission (topic executive/inputs): it was recorded before there were"
                " any, or by another profile"
            )
        if len(names) > 1:
            raise Kr3Error(f"{file} holds inputs on {len(names)} topics: {', '.join(names)}")
        try:
            for _, message, _ in bag.read_messages(topics=names):
                lines.append(line_of(message))
        except (rosbag.ROSBagException, OSError, EOFError) as error:
            raise Kr3Error(f"{file} is damaged after {len(lines)} inputs: {error}") from error
        except Kr3Error as error:
            raise Kr3Error(f"{file}: {error}") from error
    return lines


def line_of(message: Any) -> str:
    """@param message  a kr3_msgs/MissionInput. @throws Kr3Error  its kind or its data are malformed"""
    place = f"input {message.sequence}"
    if message.kind >= len(_KINDS):
        raise Kr3Error(f"{place}: kind {message.kind}, expected less than {len(_KINDS)}")
    kind = _KINDS[message.kind]
    try:
        data = json.loads(message.data)
    except json.JSONDecodeError as error:
        raise Kr3Error(f"{place} ({kind}): the data are no JSON: {error}") from error
    line = {
        "sequence": message.sequence,
        "kind": kind,
        "stamp_s": message.header.stamp.to_sec(),
        "data": data,
    }
    return json.dumps(line)
