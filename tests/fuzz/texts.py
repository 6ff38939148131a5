"""Small text files: right ones, damaged by what people, editors and attackers do to text."""

import random
import re
from typing import Final

from pydantic import BaseModel

from neurotouch_hid.device.outputs.identity import choose_identity
from neurotouch_hid.driver.camera_settings import CameraSettings
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.driver.service_settings import ServiceSettings
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DeviceError, ProfileError, RecordingError
from neurotouch_hid.profile.reading.load import load_settings
from neurotouch_hid.profile.schema.user import UserSettings
from neurotouch_hid.recording import read_labels
from neurotouch_hid.source.rig_file import load_rig_file
from tests.fuzz.area import Area

TOKENS: Final = [
    *"{}[](),:-?&*!|>%@`#'\"\n\t \\~<=.+/",
    *("\n  ", ": ", "- ", "? ", "---\n", "...\n", "<<: ", "&a ", "*a", "!!int ", "\r\n", "# "),
    *("0", "-1", "1e308", "1e999", "9" * 19, "9" * 70, "9" * 5000, "0x1F", "1_0", "-0.0", "-_"),
    *(".nan", "-.inf", "nan", "inf", "true", "null", "yes", "2020-99-99", "''", '""', '"""', "٣"),
    *("\\U99999999", '"\\ud800"', "\\x00", "\x00", "\x1b[2J", "\u2028", "\x85", "\ufeff", "🙂"),
    *("[[", "]]", "[" * 40, "{a: " * 40, "x" * 3000, "&a [*a, *a]"),
]
_WORD: Final = re.compile(r"[\w.+-]+")


def mutate(text: str, chance: random.Random) -> bytes:
    """Returns a text with one to five slips, as bytes; few of them are no text any more."""
    for _ in range(chance.choice((1, 1, 1, 2, 5))):
        text = chance.choice(_SLIPS)(text, chance)[: 200 << 10]
    content = bytearray(text.encode("utf-8", "surrogatepass"))
    if content and chance.random() < 0.1:
        content[chance.randrange(len(content))] = chance.randrange(256)
    if chance.random() < 0.002:
        content += b"#" * (100 << 10)
    return bytes(content)


def _insert(text: str, chance: random.Random) -> str:
    at = chance.randint(0, len(text))
    return text[:at] + chance.choice(TOKENS) * chance.choice((1, 1, 1, 3)) + text[at:]


def _cut(text: str, chance: random.Random) -> str:
    at = chance.randint(0, len(text))
    return text[:at] + text[at + chance.choice((1, 2, 8, 40, 1000)) :]


def _replace_word(text: str, chance: random.Random) -> str:
    words = list(_WORD.finditer(text))
    if not words:
        return text
    word = chance.choice(words)
    new = chance.choice([*TOKENS, chance.choice(words)[0], str(chance.randint(-(10**6), 10**6))])
    return text[: word.start()] + new + text[word.end() :]


def _move_line(text: str, chance: random.Random) -> str:
    lines = text.split("\n")
    line = chance.choice(lines)
    if chance.random() < 0.5:
        lines.remove(line)
    lines.insert(chance.randint(0, len(lines)), chance.choice(("", "  ", "\t")) + line)
    return "\n".join(lines)


_SLIPS: Final = (_insert, _cut, _replace_word, _replace_word, _move_line)


def _settings(model: type[BaseModel], text: str) -> Area:
    return Area(
        lambda chance: mutate(text, chance),
        lambda path: load_settings(path, model),
        ProfileError,
        ".yaml",
        lines=200,
    )


RIGS: Final = Area(
    lambda chance: mutate(
        "centre_px: [173.0, 130.0]   # in px\npx_per_mm: 2.5\nrotation_deg: -1\nmirrored: true\n",
        chance,
    ),
    load_rig_file,
    RecordingError,
    ".rig.yaml",
)
_LABELS: Final = (
    "timestamp_us,gesture,intensity_mm,contacts,x1_px,y1_px,x2_px,y2_px,x3_px,y3_px\n"
    "10000,none,0.000,0,,,,,,\n20000,push,2.500,1,170.5,131.000,,,,\n"
    '30000,pinch,"3.1",2,150.0,131.0,190.0,131.0,,\n40000,twist_ccw,9,3,1,2,3,4,5,6\n'
)
LABELS: Final = Area(
    lambda chance: mutate(_LABELS, chance), read_labels, RecordingError, ".labels.csv"
)
IDENTITIES: Final = Area(
    lambda chance: mutate(
        'name = "My gel"\nvendor = 0x1209\nproduct = 0x4E54\nversion = 0x0101\nlayout = "xbox"\n',
        chance,
    ),
    lambda path: choose_identity(str(path), "uinput"),
    DeviceError,
    ".toml",
)
USERS: Final = _settings(
    UserSettings,
    "version: 1\nrange:\n  push_left: {rest: 0.4, full: 3.5}\n  zoom: {full: 2}\nmirror: true\n"
    "rotate_deg: 90\nslots: [racing, menu]\nunused: [zoom]\ntiming: {tap_ms: 400}\n",
)
DRIVERS: Final = _settings(
    DriverSettings,
    'version: 1\napplications:\n  - {window: "firefox", profile: mouse}\n'
    "chords: {panic: backspace+escape, pause: ctrl+alt+p}\nyield_to_mouse_ms: 1500\n"
    "copilot:\n  device: auto\n  priority: helper\n  keys: {KEY_SPACE: a}\n",
)
SERVICES: Final = _settings(
    ServiceSettings,
    'version: 1\nprofile: racing\ncamera: "00000123"\ndevice: hid\nidentity: own\n',
)
CAMERAS: Final = _settings(
    CameraSettings,
    "version: 1\nexposure_us: 4000\nframe_interval_us: 40000\nactivity_filter_us: 2000\n"
    "hot_pixels: [[3, 4], [345, 259]]\nmirrored: false\nbiases: {OnBn: [5, 255], PrBp: [2, 58]}\n",
)
_GELS: Final = (
    "version: 1\nname: hex\nlayout: {kind: hex, pitch_mm: 4.65, radius_mm: 30}\ndots: dark\n",
    "layout: {kind: grid, columns: 10, rows: 7, pitch_mm: [4, 4.5]}\ndot_mm: 1\n"
    "dome_height_mm: 0\n",
    f"layout: {{kind: points, points_mm: {[[3 * (k % 7), 3.5 * (k // 7)] for k in range(42)]}}}\n",
)
GELS: Final = Area(
    lambda chance: mutate(chance.choice(_GELS), chance),
    lambda path: choose_gel(str(path)),
    ProfileError,
    ".gel.yaml",
    lines=200,
)
