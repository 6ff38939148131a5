"""The node of the ROS 2 package, without ROS: records of any attributes, and what was sent."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from neurotouch_hid.stream import Reading
from neurotouch_hid.vocabulary import Axis, Button
from tests.stream.test_targets import PINCH

ROS2 = Path(__file__).parents[2] / "integrations" / "ros2"
MESSAGES = {
    "geometry_msgs.msg": ("Point", "Pose", "PoseArray", "Vector3"),
    "neurotouch_msgs.msg": ("Touch",),
    "sensor_msgs.msg": ("Joy",),
}


class Record(SimpleNamespace):
    def __init__(self, **fields):
        super().__init__(header=SimpleNamespace(), **fields)


class Node:
    markers = False

    def __init__(self, name, namespace):
        self.sent = {}

    def declare_parameter(self, name, default):
        return SimpleNamespace(value=self.markers)

    def create_publisher(self, kind, topic, depth):
        return SimpleNamespace(publish=lambda message: self.sent.update({topic: message}))

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: 7))


@pytest.fixture
def package(monkeypatch):
    ros = {"rclpy": {}, "rclpy.node": {"Node": Node}}
    ros["rclpy.executors"] = {"ExternalShutdownException": type("Shutdown", (Exception,), {})}
    for name, kinds in MESSAGES.items():
        ros[name.partition(".")[0]] = {}
        ros[name] = {kind: type(kind, (Record,), {}) for kind in kinds}
    for name, content in ros.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    place = ROS2 / "neurotouch_ros" / "neurotouch_ros" / "publish.py"
    spec = importlib.util.spec_from_file_location("publish", place)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def list_fields():
    """The names and the types in our message."""
    lines = (ROS2 / "neurotouch_msgs" / "msg" / "Touch.msg").read_text().splitlines()
    words = [line.partition("#")[0].split() for line in lines]
    return {name: kind for kind, name in filter(None, words)}


def test_a_state_becomes_three_messages(package):
    node = package.TouchPublisher()
    node.send(PINCH)
    joy, touch, contacts = (node.sent[each] for each in ("joy", "touch", "contacts"))
    assert joy.axes == [0.5 if axis is Axis.LEFT_TRIGGER else 0.0 for axis in Axis]
    assert joy.buttons == [int(button is Button.A) for button in Button]
    assert (touch.kind, touch.simulated) == ("pinch", True)
    assert touch.intensity == pytest.approx(0.00325)
    assert [(each.position.x, each.position.y) for each in contacts.poses] == [
        (-0.01, 0.001),
        (0.01, 0.002),
    ]
    assert "markers" not in vars(touch)
    assert {each.header.frame_id for each in (joy, touch, contacts)} == {"neurotouch_gel"}


def test_the_message_has_each_field_that_the_node_sets(package, monkeypatch):
    monkeypatch.setattr(Node, "markers", True)
    node = package.TouchPublisher()
    for reading in (PINCH, Reading()):
        node.send(reading)
        assert vars(node.sent["touch"]).keys() == list_fields().keys()


def test_the_readme_names_axes_and_buttons_in_their_order():
    text = " ".join((ROS2 / "README.md").read_text().split())
    for controls in (Axis, Button):
        assert ", ".join(f"`{each}`" for each in controls) in text
