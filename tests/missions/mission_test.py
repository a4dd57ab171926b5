#!/usr/bin/python3
"""The whole mission on the whole stack: `mission_test.py default|other` says where the object asked for really is."""
import os
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rosgraph
import rostest

from kr3_experiments.bringup import World, start_stack
from kr3_experiments.demo import Observers, mission_verdict, run_mission
from kr3_experiments.domain import load_domain, repository_root
from kr3_experiments.events import EventKind
from kr3_experiments.stack import Stack
from kr3_experiments.terminal import Terminal

DOMAIN = "office"
REAL_TIME_FACTOR = 4.0
MISSION_LIMIT_S = 300.0  # wall time


def draw_source() -> random.Random:
    """What worlds are drawn from: KR3_DRAW when it is set, else the commit, so that a failure can be repeated."""
    text = os.environ.get("KR3_DRAW")
    if text is None:
        command = ["git", "-C", str(repository_root()), "rev-parse", "HEAD"]
        text = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    return random.Random(text)


def drawn_world(kind: str) -> World:
    """`default`: the place of the default, which the scenario names first; `other`: drawn among the rest."""
    domain = load_domain(DOMAIN, repository_root())
    default_place, *others = domain.target.may_be_at
    draw = draw_source()
    if kind == "default":
        return World(domain, 1, default_place, REAL_TIME_FACTOR)
    place = draw.choice(others)
    return World(domain, draw.randrange(1, 10**6), place, REAL_TIME_FACTOR, lockstep=True)


class Mission(unittest.TestCase):
    """One mission; the checks share its outcome."""

    def test_the_object_is_fetched(self) -> None:
        if "KR3_QUICK_TESTS" in os.environ:
            self.skipTest("KR3_QUICK_TESTS is set")
        world = drawn_world(sys.argv[1])
        note = f"seed {world.seed}, {world.domain.target.object} at {world.target_at}"
        print(f"mission: {note}")
        terminal = Terminal()
        with tempfile.TemporaryDirectory(prefix="kr3_mission_") as folder:
            run_dir = Path(folder)
            with Stack(run_dir, terminal.detail) as stack:
                stack.use_master(rosgraph.get_master_uri())
                start_stack(stack, world, run_dir, None)
                observers = Observers(terminal)
                mission = run_mission(stack, world.domain.goal, MISSION_LIMIT_S, observers)
                verdict = mission_verdict(stack, world, mission.result, observers, own_goal=True)
        self.assertTrue(verdict.success, f"{note}: {verdict.reason}")
        kinds = [event.kind for event in observers.follower.events]
        self.assertEqual(kinds[0], EventKind.GOAL)
        self.assertEqual(kinds[-1], EventKind.DONE)
        self.assertEqual(kinds.count(EventKind.LL_ACTION), mission.result.ll_actions)
        self.assertIsNotNone(observers.looks.found_image, f"{note}: no camera frame of the find")
        if sys.argv[1] == "other":
            self.assertIn(EventKind.DIAGNOSIS, kinds, f"{note}: the surprise was not explained")
            self.assertGreater(kinds.count(EventKind.PLAN), 1, note)


if __name__ == "__main__":
    rostest.rosrun("kr3_integration_tests", "mission", Mission, sys.argv)
