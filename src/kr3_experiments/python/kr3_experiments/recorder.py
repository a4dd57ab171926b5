"""Recording a bag by a profile: free space checked first, `rosbag record` ended properly, partial bags named so."""
import shutil
import time
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

import rospy

from kr3_experiments.errors import Kr3Error
from kr3_experiments.processes import ManagedProcess, end_processes
from kr3_experiments.stack import Stack
from kr3_experiments.yaml_file import read_mapping


@dataclass(frozen=True)
class Profile:
    """What to record. `min_free_mb`: free disk space without which recording does not start."""

    topics: List[str]
    min_free_mb: int
    stop_below_mb: int  # rosbag stops writing when less is free


def load_profile(file: Path) -> Profile:
    """@throws Kr3Error  the file is missing or malformed"""
    expected = "expected topics, min_free_mb and stop_below_mb"
    content = read_mapping(file, expected)
    try:
        profile = Profile(
            topics=[str(topic) for topic in content["topics"]],
            min_free_mb=int(content["min_free_mb"]),
            stop_below_mb=int(content["stop_below_mb"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise Kr3Error(f"{file}: {expected} ({error})") from error
    if not profile.topics:
        raise Kr3Error(f"{file}: no topics")
    return profile


def require_space(folder: Path, needed_mb: int) -> None:
    """@throws Kr3Error  less than `needed_mb` is free where `folder` is"""
    free_mb = shutil.disk_usage(folder).free // 2**20
    if free_mb < needed_mb:
        raise Kr3Error(
            f"no space for the bag: {free_mb} MB are free at {folder}, {needed_mb} MB are needed"
            " (free some, or run without a bag: --no-bag)"
        )


class Recorder:
    """One running `rosbag record`."""

    def __init__(self, process: ManagedProcess, bag: Path):
        self._process = process
        self._bag = bag

    @property
    def bag(self) -> Path:
        """Where the bag is, or will be when the recording stops."""
        return self._bag

    def is_recording(self) -> bool:
        """Whether the file is open."""
        return self._process.exit_code() is None and active_file(self._bag).exists()

    def stop(self, complete: bool = True) -> Optional[Path]:
        """End the recording and wait until the file is closed.

        @param complete  False: the mission did not end; the bag is renamed to say that it is partial
        @return the finished bag; None when there is none
        """
        end_processes([self._process])
        leftover = active_file(self._bag)
        if leftover.exists():
            self._bag = leftover.rename(self._bag.with_suffix(".unindexed.bag"))
            return self._bag
        if not self._bag.exists():
            return None
        if not complete:
            self._bag = self._bag.rename(self._bag.with_suffix(".partial.bag"))
        return self._bag


def active_file(bag: Path) -> Path:
    """What rosbag calls a bag while it writes it."""
    return bag.with_name(bag.name + ".active")


def start_recording(stack: Stack, profile: Profile, bag: Path, timeout_s: float = 20.0) -> Recorder:
    """@throws Kr3Error  too little disk space, or the recording did not start"""
    require_space(bag.parent, profile.min_free_mb)
    command = [stack.executable("rosbag", "record"), "--lz4", "--buffsize=128", "-O", str(bag)]
    command += [f"--min-space={profile.stop_below_mb}M", "__name:=kr3_recorder"]
    command += [rospy.resolve_name(topic) for topic in profile.topics]
    recorder = Recorder(stack.start_unwatched("recorder", command), bag)
    deadline = time.monotonic() + timeout_s
    while not recorder.is_recording():
        if time.monotonic() > deadline:
            raise Kr3Error(
                f"the recording did not start within {timeout_s:.0f} s (see log/recorder.log)"
            )
        stack.poll()
        time.sleep(0.05)
    return recorder
