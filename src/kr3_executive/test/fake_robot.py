"""A robot for tests of the skills: speaks the robot's, the navigator's and the detector's topics, on an empty floor."""
import math
import threading

import actionlib
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist
from kr3_msgs.msg import Cell, CellArray, Detection, DetectionArray, Status
from kr3_msgs.srv import CloseGripper, CloseGripperResponse, OpenGripper, OpenGripperResponse
from move_base_msgs.msg import MoveBaseAction, MoveBaseResult
from nav_msgs.msg import OccupancyGrid, Odometry
from sensor_msgs.msg import CameraInfo, LaserScan
from std_msgs.msg import Bool

RATE_HZ = 50.0
VIEW_RAD = 1.2
REACH_M = 0.75
WIDTH_M = 4.0  # of the floor, and of every cell
RESOLUTION_M = 0.1
HELD = "held"


def quaternion_z(yaw):
    return math.sin(yaw / 2.0), math.cos(yaw / 2.0)


class FakeRobot:
    """Follows cmd_vel exactly on a floor of cells side by side along x, and carries objects. All in `map`.

    cells: (name, room, length along x in metres) from x = 0 on; objects: where each is, (x, y), HELD or None.
    """

    def __init__(self, cells, objects):
        self.lock = threading.RLock()
        self.x, self.y, self.yaw = 2.0, 2.0, 0.0
        self.speed, self.turn = 0.0, 0.0
        self.objects = dict(objects)
        self.reachable = True
        self.frames = 0
        self.tf = tf2_ros.TransformBroadcaster()
        self.odom = rospy.Publisher("odom", Odometry, queue_size=1)
        self.scan = rospy.Publisher("scan", LaserScan, queue_size=1)
        self.detections = rospy.Publisher("detections", DetectionArray, queue_size=1)
        self.info = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=1, latch=True)
        focal = 320.0 / math.tan(VIEW_RAD / 2.0)
        self.info.publish(
            CameraInfo(width=640, height=480, K=[focal, 0, 320, 0, focal, 240, 0, 0, 1])
        )
        self.holding = rospy.Publisher("gripper/holding", Bool, queue_size=1, latch=True)
        self.holding.publish(Bool(False))
        self.cells = rospy.Publisher("cells", CellArray, queue_size=1, latch=True)
        self.places = self.place(cells)
        self.cells.publish(self.places)
        self.map = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        grid = OccupancyGrid()
        grid.info.resolution = RESOLUTION_M
        grid.info.width = round(sum(length for _, _, length in cells) / RESOLUTION_M)
        grid.info.height = round(WIDTH_M / RESOLUTION_M)
        grid.data = [0] * (grid.info.width * grid.info.height)
        self.map.publish(grid)
        rospy.Subscriber("cmd_vel", Twist, self.on_command)
        rospy.Service("gripper/close", CloseGripper, self.on_close)
        rospy.Service("gripper/open", OpenGripper, self.on_open)
        self.driver = actionlib.SimpleActionServer(
            "move_base", MoveBaseAction, self.on_goal, auto_start=False
        )
        self.driver.start()
        self.timer = rospy.Timer(rospy.Duration(1.0 / RATE_HZ), self.step)

    @staticmethod
    def place(cells):
        message, left = CellArray(), 0.0
        for index, (name, room, length) in enumerate(cells):
            cell = Cell(name=name, room=room, size_x=length, size_y=WIDTH_M)
            cell.center.x, cell.center.y = left + length / 2.0, WIDTH_M / 2.0
            cell.neighbors = [cells[k][0] for k in (index - 1, index + 1) if 0 <= k < len(cells)]
            left += length
            message.cells.append(cell)
        centers = [cell.center.x for cell in message.cells]
        message.travel_distance = [abs(a - b) for a in centers for b in centers]
        return message

    def on_command(self, twist):
        with self.lock:
            self.speed, self.turn = twist.linear.x, twist.angular.z

    def held(self):
        """The name of the object in the gripper, or None."""
        return next((name for name, at in self.objects.items() if at == HELD), None)

    def in_front(self):
        return self.x + 0.5 * math.cos(self.yaw), self.y + 0.5 * math.sin(self.yaw)

    def release(self):
        """What the gripper holds stands in front of the robot. Returns whether it held anything."""
        with self.lock:
            name = self.held()
            if name is not None:
                self.objects[name] = self.in_front()
            self.holding.publish(Bool(False))
            return name is not None

    def from_robot(self, point):
        dx, dy = point[0] - self.x, point[1] - self.y
        bearing = math.atan2(dy, dx) - self.yaw
        return math.hypot(dx, dy), math.atan2(math.sin(bearing), math.cos(bearing))

    def on_close(self, _):
        with self.lock:
            for name, point in self.objects.items():
                if self.held() is None and isinstance(point, tuple):
                    distance, bearing = self.from_robot(point)
                    if distance < REACH_M and abs(bearing) < 0.6:
                        self.objects[name] = HELD
            holds = self.held() is not None
            self.holding.publish(Bool(holds))
            return CloseGripperResponse(Status(), holds)

    def on_open(self, _):
        return OpenGripperResponse(Status(), self.release())

    def stand_at(self, x, y, yaw=0.0):
        """Takes the robot somewhere, standing still."""
        with self.lock:
            self.x, self.y, self.yaw = x, y, yaw
            self.speed = self.turn = 0.0
            self.step(None)

    def on_goal(self, goal):
        with self.lock:
            if not self.reachable:
                self.driver.set_aborted(MoveBaseResult())
                return
            pose = goal.target_pose.pose
            self.stand_at(
                pose.position.x,
                pose.position.y,
                2.0 * math.atan2(pose.orientation.z, pose.orientation.w),
            )
        self.driver.set_succeeded(MoveBaseResult())

    def transform(self, parent, child, x, y, z, rotation):
        message = TransformStamped()
        message.header.stamp, message.header.frame_id, message.child_frame_id = (
            self.now,
            parent,
            child,
        )
        t = message.transform
        t.translation.x, t.translation.y, t.translation.z = x, y, z
        t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w = rotation
        return message

    def step(self, _):
        with self.lock:
            self.now = rospy.Time.now()
            self.yaw += self.turn / RATE_HZ
            self.x += self.speed * math.cos(self.yaw) / RATE_HZ
            self.y += self.speed * math.sin(self.yaw) / RATE_HZ
            sine, cosine = quaternion_z(self.yaw)
            identity, optical = (0, 0, 0, 1), (-0.5, 0.5, -0.5, 0.5)
            self.tf.sendTransform(
                [
                    self.transform("map", "base_link", self.x, self.y, 0.0, (0, 0, sine, cosine)),
                    self.transform("base_link", "laser", 0.0, 0.0, 0.3, identity),
                    self.transform("base_link", "camera_optical_frame", 0.0, 0.0, 0.6, optical),
                ]
            )
            odom = Odometry()
            odom.header.stamp = self.now
            odom.pose.pose.position.x, odom.pose.pose.position.y = self.x, self.y
            odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = sine, cosine
            odom.twist.twist.linear.x, odom.twist.twist.angular.z = self.speed, self.turn
            self.odom.publish(odom)
            scan = LaserScan(
                angle_min=-math.pi, angle_max=math.pi, angle_increment=math.pi / 180, range_max=12.0
            )
            scan.header.frame_id, scan.header.stamp = "laser", self.now
            scan.ranges = [math.inf] * 361
            self.scan.publish(scan)
            self.frames += 1
            if self.frames % 5 == 0:
                self.detections.publish(self.picture())

    def picture(self):
        message = DetectionArray()
        message.header.stamp, message.header.frame_id = self.now, "camera_optical_frame"
        for name, point in self.objects.items():
            if not isinstance(point, tuple):
                continue
            distance, bearing = self.from_robot(point)
            if abs(bearing) < VIEW_RAD / 2.0:
                found = Detection(
                    name=name, class_name="thing", probability=0.95, has_position=True
                )
                found.position.x = -distance * math.sin(bearing)
                found.position.y = 0.5  # on the floor: below the laser
                found.position.z = distance * math.cos(bearing)
                message.detections.append(found)
        return message
