#!/usr/bin/python3
"""Contract of navigation_node while it builds a map, and of build_map: the map they leave serves to drive in."""

import pathlib
import subprocess
import sys
import unittest

import rospkg
import rospy
import rostest
from kr3_msgs.msg import CellArray

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from fake_robot import FakeRobot  # noqa: E402


class MappingTest(unittest.TestCase):
    def test_builds_and_saves_the_map(self):
        FakeRobot(2.0, 3.0, 0.0)
        done = subprocess.run(
            ["rosrun", "kr3_navigation", "build_map"],
            capture_output=True,
            text=True,
            timeout=120.0,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("8 of 8 cells visited", done.stdout)
        # the node's working directory is ROS's
        saved = pathlib.Path(rospkg.get_ros_home()) / rospy.get_param("/navigation_node/map_out")
        self.assertTrue(saved.read_bytes().startswith(b"# Octomap OcTree binary file"))
        saved.unlink()
        cells = rospy.wait_for_message("cells", CellArray, timeout=30.0)
        names = {cell.name: cell for cell in cells.cells}
        # With the finished map, unknown space is no way through walls.
        self.assertNotIn("right_c0", names["left_c0"].neighbors)
        self.assertIn("right_c0", names["left_c1"].neighbors)


if __name__ == "__main__":
    rospy.init_node("mapping_test")
    rostest.rosrun("kr3_navigation", "mapping_test", MappingTest)
