"""The node: each state of the running driver becomes three messages."""

import math

import rclpy
from geometry_msgs.msg import Point, Pose, PoseArray, Vector3
from neurotouch_msgs.msg import Touch
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import Joy

from neurotouch_hid.stream import Reading, read_states

FRAME = "neurotouch_gel"
HZ = 60
M = 0.001  # of a mm


class TouchPublisher(Node):
    """Publishes ``joy``, ``touch`` and ``contacts`` below ``/neurotouch``."""

    def __init__(self):
        super().__init__("neurotouch", namespace="neurotouch")
        self._has_markers = self.declare_parameter("markers", False).value
        self._joy = self.create_publisher(Joy, "joy", 10)
        self._touch = self.create_publisher(Touch, "touch", 10)
        self._contacts = self.create_publisher(PoseArray, "contacts", 10)

    def send(self, reading):
        """Publishes a state."""
        joy, touch, contacts = Joy(), Touch(), PoseArray()
        for each in (joy, touch, contacts):
            each.header.stamp = self.get_clock().now().to_msg()
            each.header.frame_id = FRAME
        joy.axes = [float(each) for each in reading.axes.values()]
        joy.buttons = [int(each) for each in reading.buttons.values()]
        touch.state, touch.simulated = reading.state, reading.simulated
        touch.kind, touch.movement = reading.kind, reading.movement
        touch.intensity = M * reading.intensity_mm
        touch.confidence, touch.scale = float(reading.confidence), float(reading.scale)
        touch.turned = float(reading.turned_rad)
        touch.moved = Vector3(x=M * reading.moved_mm[0], y=M * reading.moved_mm[1], z=0.0)
        touch.contacts = [Point(x=M * x, y=M * y, z=0.0) for x, y in reading.contacts_mm]
        if self._has_markers:
            moved = reading.markers_mm.tolist()
            touch.markers = [Vector3(x=M * x, y=M * y, z=0.0) for x, y in moved]
        contacts.poses = [Pose(position=point) for point in touch.contacts]
        self._joy.publish(joy)
        self._touch.publish(touch)
        self._contacts.publish(contacts)


def main():
    """Publishes until ROS ends the node; all at rest is sent at last."""
    rclpy.init()
    node = TouchPublisher()
    try:
        for reading in read_states(HZ, math.inf):
            if not rclpy.ok():
                break
            node.send(reading)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if rclpy.ok():
            node.send(Reading())
        node.destroy_node()
        rclpy.try_shutdown()
