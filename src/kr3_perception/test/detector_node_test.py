#!/usr/bin/python3
"""Contract of detector_node: it starts, detects, survives bad images and sleeps when nobody listens."""
import pathlib
import signal
import subprocess
import sys
import threading
import unittest

import cv2
import numpy
import rospy
import rostest
from kr3_msgs.msg import DetectionArray
from sensor_msgs.msg import CameraInfo, Image

OFFICE = pathlib.Path(__file__).resolve().parents[3] / "domains" / "office"
DEADLINE_S = 20.0
FOCAL = 457.0


FRONT = (300, 180, 84, 112)  # x, y, width, height of the object in the pictures below, px


def overlap(region, box) -> float:
    """Intersection over union of a detection's region and a box."""
    x, y, width, height = box
    across = min(region.x_offset + region.width, x + width) - max(region.x_offset, x)
    down = min(region.y_offset + region.height, y + height) - max(region.y_offset, y)
    common = max(0, across) * max(0, down)
    return common / (region.width * region.height + width * height - common)


def picture_of(texture: str) -> numpy.ndarray:
    """The texture as a flat front of 84 x 112 px before a plain wall."""
    image = numpy.full((480, 640, 3), (205, 215, 220), numpy.uint8)
    front = cv2.resize(
        cv2.imread(str(OFFICE / "textures" / texture)), (84, 112), interpolation=cv2.INTER_AREA
    )
    image[180:292, 300:384] = front
    return image


def image_message(pixels: numpy.ndarray, stamp: float) -> Image:
    message = Image(
        height=pixels.shape[0], width=pixels.shape[1], encoding="bgr8", step=pixels.shape[1] * 3
    )
    message.header.frame_id = "camera_optical_frame"
    message.header.stamp = rospy.Time.from_sec(stamp)
    message.data = pixels.tobytes()
    return message


def camera_info(focal: float = FOCAL, width: int = 640, distortion=()) -> CameraInfo:
    return CameraInfo(
        width=width, height=480, K=[focal, 0, 320, 0, FOCAL, 240, 0, 0, 1], D=distortion
    )


def wait_until(condition) -> bool:
    """Polls, with a deadline in wall time."""
    event = threading.Event()
    for _ in range(int(DEADLINE_S / 0.02)):
        if condition():
            return True
        event.wait(0.02)
    return False


class DetectorNodeTest(unittest.TestCase):
    def setUp(self):
        self.start({})

    def start(self, parameters):
        """The node and what it listens to."""
        model = str(OFFICE / "perception.yml.gz")
        rospy.set_param("/detector_node", {"model": model, **parameters})
        self.node = subprocess.Popen(["rosrun", "kr3_perception", "detector_node"])
        self.images = rospy.Publisher("camera/image_raw", Image, queue_size=1)
        self.infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=1, latch=True)
        self.infos.publish(camera_info())
        self.received = []
        self.stamp = 100.0

    def tearDown(self):
        if self.node.poll() is None:
            self.node.send_signal(signal.SIGINT)
        self.node.wait(DEADLINE_S)
        self.images.unregister()
        self.infos.unregister()

    def listen(self) -> rospy.Subscriber:
        subscriber = rospy.Subscriber("detections", DetectionArray, self.received.append)
        self.assertTrue(
            wait_until(lambda: self.images.get_num_connections() > 0),
            "the node does not ask for images",
        )
        return subscriber

    def answer_to(self, message: Image) -> DetectionArray:
        self.images.publish(message)
        stamp = message.header.stamp
        self.assertTrue(
            wait_until(lambda: any(m.header.stamp == stamp for m in self.received)), "no detections"
        )
        return next(m for m in self.received if m.header.stamp == stamp)

    def position_known(self) -> bool:
        self.stamp += 1.0
        return (
            self.answer_to(image_message(picture_of("tb1.png"), self.stamp))
            .detections[0]
            .has_position
        )

    def test_detects_survives_and_stops(self):
        subscriber = self.listen()
        answer = self.answer_to(image_message(picture_of("tb1.png"), 1.0))
        self.assertEqual(answer.header.frame_id, "camera_optical_frame")
        self.assertEqual([d.name for d in answer.detections], ["tb1"])
        found = answer.detections[0]
        self.assertEqual(found.class_name, "textbook")
        self.assertGreater(found.probability, 0.5)
        self.assertTrue(found.has_position)
        self.assertAlmostEqual(
            found.position.z, FOCAL * 0.28 / 112, delta=0.1
        )  # metres: height 0.28 m over 112 px
        self.assertGreater(overlap(found.region, FRONT), 0.6)

        empty = self.answer_to(
            image_message(numpy.full((480, 640, 3), (205, 215, 220), numpy.uint8), 2.0)
        )
        self.assertEqual(empty.detections, [])

        broken = image_message(picture_of("tb1.png"), 3.0)
        broken.data = broken.data[:1000]
        odd = image_message(picture_of("tb1.png"), 4.0)
        odd.encoding = "made_up"
        # 4 GB by its numbers, whose product in 32 bits is the 64 KiB that there are.
        huge = Image(height=65536, width=1, step=65537, encoding="bgr8", data=bytes(65536))
        wide = Image(height=1, width=2**31, step=2**31, encoding="mono8")
        for number, message in enumerate((Image(), broken, odd, huge, wide)):
            self.images.publish(message)
            self.answer_to(image_message(picture_of("tb2.png"), 3.1 + 0.1 * number))
        again = self.answer_to(image_message(picture_of("tb2.png"), 5.0))
        self.assertEqual([d.name for d in again.detections], ["tb2"])

        for focal, width, distortion in (
            (FOCAL, 640, [0.1, 0.2, 0.3]),
            (FOCAL, 640, [float("nan")] * 5),
            (float("inf"), 640, []),
            (FOCAL, 2**31, []),
        ):
            self.infos.publish(camera_info())
            self.assertTrue(wait_until(self.position_known))
            self.infos.publish(camera_info(focal, width, distortion))
            self.assertTrue(
                wait_until(lambda: not self.position_known()), "a bad calibration gives positions"
            )

        subscriber.unregister()
        self.assertTrue(
            wait_until(lambda: self.images.get_num_connections() == 0), "still asks for images"
        )
        self.node.send_signal(signal.SIGINT)
        self.assertEqual(self.node.wait(DEADLINE_S), 0)

    def test_draws_when_somebody_looks(self):
        pictures = []
        rospy.Subscriber("detections/image", Image, pictures.append)
        self.assertTrue(wait_until(lambda: self.images.get_num_connections() > 0))
        pixels = picture_of("tb1.png")
        self.images.publish(image_message(pixels, 1.0))
        self.assertTrue(wait_until(lambda: pictures))
        self.assertEqual((pictures[0].height, pictures[0].width), (480, 640))
        self.assertNotEqual(pictures[0].data, pixels.tobytes())

    def test_looks_at_one_image_of_each_period(self):
        self.tearDown()
        self.start({"max_rate": 5.0})
        self.listen()
        pixels = picture_of("tb1.png")
        for stamp in (10.05, 10.1, 10.25, 10.3, 10.45, 9.05):  # the last one: time went back
            self.images.publish(image_message(pixels, stamp))
            if stamp not in (10.1, 10.3):
                expected = rospy.Time.from_sec(stamp)
                self.assertTrue(
                    wait_until(lambda: any(m.header.stamp == expected for m in self.received)),
                    f"no detections at {stamp}",
                )
        seen = [round(message.header.stamp.to_sec(), 3) for message in self.received]
        self.assertEqual(seen, [10.05, 10.25, 10.45, 9.05])

    def test_refuses_bad_parameters(self):
        for params, word in (
            ({"model": "/nowhere.yml.gz"}, "/nowhere.yml.gz"),
            ({"model": str(OFFICE / "objects.yaml")}, "objects.yaml"),
            ({"model": str(OFFICE / "perception.yml.gz"), "min_probabilty": 0.5}, "min_probabilty"),
            ({"model": str(OFFICE / "perception.yml.gz"), "max_rate": -1.0}, "max_rate"),
            ({}, "model"),
        ):
            rospy.set_param("/other_detector", params)
            result = subprocess.run(
                ["rosrun", "kr3_perception", "detector_node", "__name:=other_detector"],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=DEADLINE_S,
                text=True,
            )
            rospy.delete_param("/other_detector")
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(word, result.stdout)


if __name__ == "__main__":
    rospy.init_node("detector_node_test")
    rostest.rosrun("kr3_perception", "detector_node", DetectorNodeTest, sys.argv)
