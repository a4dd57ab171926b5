"""One mission seen from outside: sends the goal, and collects what the robot reports on the way."""
import re
import threading
from collections import OrderedDict
from typing import Callable, Dict, List, Optional, Tuple

import actionlib
import cv2
import numpy as np
import rospy
from actionlib_msgs.msg import GoalStatus
from cv_bridge import CvBridge
from geometry_msgs.msg import PoseWithCovarianceStamped
from kr3_msgs.msg import (
    AchieveAction,
    AchieveGoal,
    AchieveResult,
    DetectionArray,
    ExecuteSkillActionGoal,
    ExecuteSkillActionResult,
    ExecuteSkillResult,
    MissionEvent,
    ModelStates,
    SimulationState,
)
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import CompressedImage, Image

from kr3_experiments.errors import StackError
from kr3_experiments.events import END_KINDS, Event, event_from_message
from kr3_experiments.stack import Stack

_KEPT_IMAGES = 40
_CANCEL_S = 3.0  # wall time for a cancelled mission to end


class EventFollower:
    """Collects the executive's events and hands each to `on_event` (from a ROS thread)."""

    def __init__(self, on_event: Callable[[Event], None]):
        self.events: List[Event] = []
        self._on_event = on_event
        self._start_s: Optional[float] = None
        self._subscriber = rospy.Subscriber(
            "executive/events", MissionEvent, self._on_message, queue_size=1000
        )

    def _on_message(self, message: MissionEvent) -> None:
        stamp_s: float = message.header.stamp.to_sec()
        if self._start_s is None or message.sequence == 0:
            self._start_s = stamp_s
        event = event_from_message(message, self._start_s)
        self.events.append(event)
        self._on_event(event)

    def has_ended(self) -> bool:
        """Whether the mission's last event is there."""
        return bool(self.events) and self.events[-1].kind in END_KINDS


class LookCollector:
    """Keeps one picture of every look.

    It listens to the camera's debug image only while a search runs: the camera renders only while somebody listens.
    The picture is the one in which the object looked for was most probable, or the last one. A search can end before
    the connection to the camera stands: its picture is then the first one that comes.
    """

    def __init__(self) -> None:
        # CV_8UC3, BGR: of the last search that saw its object
        self.found_image: Optional[np.ndarray] = None
        self.found_what: List[str] = []  # arguments of that search
        self._bridge = CvBridge()
        self._lock = threading.Lock()
        self._arguments: List[str] = []
        self._images: "OrderedDict[rospy.Time, Image]" = OrderedDict()
        self._scores: Dict[rospy.Time, float] = {}
        self._listening: List[rospy.Subscriber] = []
        self._late_result: Optional[ExecuteSkillResult] = None  # of a search without a picture yet
        self._publisher = rospy.Publisher("looks/image/compressed", CompressedImage, queue_size=10)
        self._goals = rospy.Subscriber("skills/search/goal", ExecuteSkillActionGoal, self._on_goal)
        self._results = rospy.Subscriber(
            "skills/search/result", ExecuteSkillActionResult, self._on_result
        )

    def close(self) -> None:
        """Stop listening."""
        with self._lock:
            for subscriber in (self._goals, self._results, *self._listening):
                subscriber.unregister()

    def _on_goal(self, message: ExecuteSkillActionGoal) -> None:
        with self._lock:
            self._arguments = list(message.goal.arguments)
            self._images.clear()
            self._scores.clear()
            self._late_result = None
            if not self._listening:
                self._listening = [
                    rospy.Subscriber(
                        "detections/image", Image, self._on_image, queue_size=5, buff_size=2**24
                    ),
                    rospy.Subscriber(
                        "detections", DetectionArray, self._on_detections, queue_size=20
                    ),
                ]

    def _on_image(self, message: Image) -> None:
        with self._lock:
            self._images[message.header.stamp] = message
            while len(self._images) > _KEPT_IMAGES:
                self._images.popitem(last=False)
            late_result = self._late_result
        if late_result is not None:
            self._keep_picture(late_result)

    def _on_detections(self, message: DetectionArray) -> None:
        with self._lock:
            wanted = [
                item.probability for item in message.detections if item.name in self._arguments
            ]
            self._scores[message.header.stamp] = max(wanted, default=0.0)

    def _on_result(self, message: ExecuteSkillActionResult) -> None:
        self._keep_picture(message.result)

    def _keep_picture(self, result: ExecuteSkillResult) -> None:
        """Stop listening and keep the best picture of the search that ended so; without one, wait for the first."""
        with self._lock:
            if not self._images:
                self._late_result = result
                return
            self._late_result = None
            for subscriber in self._listening:
                subscriber.unregister()
            self._listening = []
            stamps = list(self._images)
            best = max(stamps, key=lambda stamp: (self._scores.get(stamp, 0.0), stamp.to_sec()))
            message_image = self._images[best]
            arguments = list(self._arguments)
        picture = self._bridge.imgmsg_to_cv2(message_image, "bgr8")
        encoded, data = cv2.imencode(".jpg", picture)
        if encoded:
            look = CompressedImage(header=message_image.header, format="jpeg", data=data.tobytes())
            self._publisher.publish(look)
        noticed = (sighting.literal for sighting in result.sightings)
        if result.outcome == "found" or any(map(self._is_of_target, noticed)):
            self.found_image = picture.copy()
            self.found_what = arguments

    def _is_of_target(self, literal: str) -> bool:
        """Whether a sighting, such as "f(a) = b", is about what the search is for."""
        about = re.fullmatch(r"\w+\(([^)]*)\) = .*", literal)
        return about is not None and any(
            name.strip() in self._arguments for name in about.group(1).split(",")
        )


class WorldCollector:
    """Keeps the robot's path, its map, the simulator's figures, and for the final check the ground truth."""

    def __init__(self) -> None:
        self.trajectory: List[Tuple[float, float, float]] = []  # time s, x m, y m; map frame
        self.map: Optional[OccupancyGrid] = None
        self.models: Optional[ModelStates] = None
        self.contacts = 0
        self._subscribers = [
            rospy.Subscriber("pose", PoseWithCovarianceStamped, self._on_pose),
            rospy.Subscriber("map", OccupancyGrid, self._on_map),
            rospy.Subscriber("ground_truth/models", ModelStates, self._on_models),
            rospy.Subscriber("simulation/state", SimulationState, self._on_simulation),
        ]

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        position = message.pose.pose.position
        if self.trajectory:
            _, x, y = self.trajectory[-1]
            if abs(position.x - x) + abs(position.y - y) < 0.02:
                return
        self.trajectory.append((message.header.stamp.to_sec(), position.x, position.y))

    def _on_map(self, message: OccupancyGrid) -> None:
        self.map = message

    def _on_models(self, message: ModelStates) -> None:
        self.models = message

    def _on_simulation(self, message: SimulationState) -> None:
        self.contacts = message.robot_contacts


def achieve(
    stack: Stack, goal: str, wall_limit_s: Optional[float], simulated_limit_s: float = 0.0
) -> AchieveResult:
    """Send the goal and wait for the result, looking after the stack. The goal is cancelled when this is interrupted.

    @throws StackError  the executive does not answer, loses the goal, or the wall time ran out
    """
    # Not the simple client: it drops transitions that come before it has stored its handle.
    client = actionlib.ActionClient("executive/achieve", AchieveAction)
    connected = threading.Event()
    # Its own timeout is in simulated time, which may stand still.

    def connect() -> None:
        if client.wait_for_server():
            connected.set()

    threading.Thread(target=connect, daemon=True).start()
    if not stack.spin_until(connected.is_set, 15.0):
        raise StackError("executive/achieve does not answer")
    finished = threading.Event()

    def on_transition(goal_handle: actionlib.ClientGoalHandle) -> None:
        if goal_handle.get_comm_state() == actionlib.CommState.DONE:
            finished.set()

    message = AchieveGoal(goal=goal, time_limit=rospy.Duration.from_sec(simulated_limit_s))
    handle = client.send_goal(message, on_transition)
    try:
        in_time = stack.spin_until(finished.is_set, wall_limit_s)
    except BaseException:
        handle.cancel()
        finished.wait(_CANCEL_S)
        raise
    if not in_time:
        handle.cancel()
        finished.wait(_CANCEL_S)
        raise StackError(f"the mission did not end within {wall_limit_s:.0f} s of wall time")
    result = handle.get_result()
    if result is None:
        state = GoalStatus.to_string(handle.get_terminal_state())
        raise StackError(
            f"the executive gave no result (goal {state}: {handle.get_goal_status_text()})"
        )
    return result
