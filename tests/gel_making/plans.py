"""Plans that the tests of this folder share."""

from neurotouch_hid.driver.gel_settings import GelSettings
from neurotouch_hid.gel_making.cameras import CAMERAS, HANDS, write_gel_file
from neurotouch_hid.gel_making.plan import Plan, make_plan
from neurotouch_hid.profile.reading import parse_settings


def write(camera: str = "webcam", hand: str = "large", way: str = "cast") -> str:
    """The text of a gel file as ``gel new`` writes it."""
    return write_gel_file("own", CAMERAS[camera][1], HANDS[hand], way)


def read(text: str) -> Plan:
    return make_plan(parse_settings(text.encode(), "gel.yaml", GelSettings))


def plan(camera: str = "webcam", hand: str = "large", way: str = "cast") -> Plan:
    return read(write(camera, hand, way))
