"""Plays ``vivid``, a camera that the kernel itself simulates, through our V4L2 layer."""

import json
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.video import v4l2
from neurotouch_hid.source.video.camera import VideoCamera
from neurotouch_hid.source.video.capture import CaptureDevice
from neurotouch_hid.source.video.config import VideoConfig
from neurotouch_hid.source.video.enumeration import find_video_cameras
from neurotouch_hid.source.video.formats import KNOWN, GreyReader
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.source.video.modes import list_modes
from neurotouch_hid.source.video.picture_stream import PictureStream

# Of drivers/media/test-drivers/vivid/vivid-ctrls.c.
TEST_PATTERN = 0x00F0F000
OSD_TEXT_MODE = TEST_PATTERN + 1
TSTAMP_SRC = TEST_PATTERN + 24
PERC_DROPPED = TEST_PATTERN + 64
DISCONNECT = TEST_PATTERN + 65
DQBUF_ERROR = TEST_PATTERN + 66
QUEUE_SETUP_ERROR = TEST_PATTERN + 67
GREY_RAMP = 20
NO_TEXT = 2
PATIENCE_S = 30.0
SIZE = (640, 360)


def load() -> Path:
    """Returns the node of the camera: one webcam, and a node that only writes."""
    subprocess.run(
        ["modprobe", "vivid", "n_devs=1", "node_types=0x101", "num_inputs=1", "input_types=0x0"],
        check=True,
    )
    (info,) = find_video_cameras()
    return info.node


def unload() -> None:
    subprocess.run(["modprobe", "-r", "vivid"], check=True)


def look(results: Path) -> dict[str, Any]:
    """What the camera says of itself, in what formats its pictures come, and how it streams."""
    node = load()
    (info,) = find_video_cameras()
    seen: dict[str, Any] = {"info": [info.name, info.driver, info.bus_info, info.reason]}
    with CaptureDevice(node) as device:
        seen["formats"] = device.list_formats()
        modes = list_modes(device)
        seen["modes"] = sorted({(m.width, m.height, round(m.fps, 2)) for m in modes})
        exposure = device.find_control(v4l2.CID_EXPOSURE_ABSOLUTE)
        seen["lacks_exposure"] = exposure is None
        gain = device.find_control(v4l2.CID_GAIN)
        seen["gain"] = None if gain is None else list(gain)
        seen["set"] = [
            device.set_control(v4l2.CID_GAIN, 55),
            device.get_control(v4l2.CID_GAIN),
            device.set_control(v4l2.CID_EXPOSURE_ABSOLUTE, 1),
        ]
        seen["refused"] = device.list_sizes("ABCD")
    seen["pictures"] = {code: look_at(node, code) for code in seen["formats"] if code in KNOWN}
    seen["stream"] = {str(source): stream(node, source) for source in (0, 1)}
    seen["busy"] = occupy(node)
    unload()
    return seen


def look_at(node: Path, fourcc: str) -> dict[str, Any]:
    """One picture of a format: a ramp from black to white, the same in each of them."""
    with CaptureDevice(node) as device:
        agreed = device.set_format(fourcc, *SIZE)
        device.set_control(TEST_PATTERN, GREY_RAMP)
        device.set_control(OSD_TEXT_MODE, NO_TEXT)
        with PictureStream(device) as pictures:
            picture = pictures.take(PATIENCE_S)
            assert picture is not None
            grey = GreyReader(agreed).read(picture.data)
        assert grey is not None
        row = grey[SIZE[1] // 2].astype(int)
        return {
            "agreed": list(agreed),
            "n_bytes": len(picture.data),
            "row": row[:: SIZE[0] // 16].tolist(),
            "same_rows": bool((np.ptp(grey.astype(int), axis=0) <= 1).mean() > 0.9),
        }


def stream(node: Path, source: int) -> dict[str, Any]:
    """Two seconds of stream, with stamps of the end of a picture (0) or the start (1)."""
    config = VideoConfig(width=SIZE[0], height=SIZE[1], format="YUYV", fps=30)
    with CaptureDevice(node) as device:
        device.set_control(TSTAMP_SRC, source)
    stamps, lateness, starts = [], [], []
    with VideoCamera(node, config) as camera:
        camera.start()
        deadline = time.monotonic() + 2.0
        while time.monotonic() < deadline:
            picture = camera.take(1.0)
            if picture is not None:
                now_us = time.monotonic_ns() // 1000
                stamps.append(picture.exposure_end_us)
                starts.append(picture.exposure_begin_us)
                lateness.append(now_us - picture.exposure_end_us)
        return {
            "mode": list(camera.mode[:3]),
            "fps": camera.mode.fps,
            "n": len(stamps),
            "lost": camera.n_lost,
            "damaged": camera.n_damaged,
            "unstamped": camera.n_unstamped,
            "ascend": bool((np.diff(stamps) > 0).all()),
            "exposure_us": stamps[0] - starts[0],
            "lateness_us": float(np.median(lateness)),
            "lacking": list(camera.lacking),
        }


def occupy(node: Path) -> list[Any]:
    """What a second program is told while a first one streams."""
    with VideoCamera(node, VideoConfig()) as first:
        first.start()
        try:
            VideoCamera(node, VideoConfig(width=640, height=360)).start()
        except CameraError as error:
            return [error.message, error.exit_code]
    return ["not refused", 0]


def suffer(results: Path) -> dict[str, Any]:
    """Lost pictures, an error, an unplugged camera: what the layer reports of each."""
    node = load()
    seen: dict[str, Any] = {}
    with VideoCamera(node, VideoConfig(width=SIZE[0], height=SIZE[1])) as camera:
        camera.start()
        with CaptureDevice(node) as other:
            other.set_control(PERC_DROPPED, 50)
        n = 0
        deadline = time.monotonic() + 3.0
        while time.monotonic() < deadline:
            n += camera.take(1.0) is not None
        with CaptureDevice(node) as other:
            other.set_control(PERC_DROPPED, 0)
        seen["dropped"] = [n, camera.n_lost]
        with CaptureDevice(node) as other:
            other.set_control(DQBUF_ERROR, 1)
        seen["error"] = [camera.n_damaged, until_error(camera), camera.n_damaged]
    with VideoCamera(node, VideoConfig()) as camera:
        camera.start()
        with CaptureDevice(node) as other:
            other.set_control(DISCONNECT, 1)
        begun = time.monotonic()
        seen["unplugged"] = [until_error(camera), time.monotonic() - begun]
    unload()
    seen["left"] = [str(info) for info in find_video_cameras()]
    node = load()
    with VideoCamera(node, VideoConfig(fps=30)) as camera:
        camera.start()
        seen["again"] = camera.take(PATIENCE_S) is not None
        seen["interval"] = camera.mode.interval == Fraction(1, 30)
    unload()
    return seen


def replug(results: Path) -> dict[str, Any]:
    """The live source on a camera that is unplugged and comes back; and what ``devices`` lists."""
    node = load()
    program = [sys.executable, "-m", "neurotouch_hid", "devices", "--json"]
    listed = subprocess.run(program, capture_output=True, text=True, check=True)
    seen: dict[str, Any] = {"listed": json.loads(listed.stdout)["video_cameras"]}
    with VideoCameraSource("vivid", VideoConfig(fps=30, format="YUYV")) as source:
        seen["name"] = source.name
        packets = play_until(source, lambda: False, 2.0)
        stats = source.stats()
        seen["frames"] = sum(len(packet.frames) for packet in packets)
        seen["lost"] = [stats.n_lost, stats.n_damaged]
        seen["fps"] = stats.fps
        seen["latency_us"] = stats.latency_us
        with CaptureDevice(node) as other:
            other.set_control(DISCONNECT, 1)
        begun = time.monotonic()
        play_until(source, lambda: source.trouble)
        seen["trouble"] = [source.trouble, time.monotonic() - begun]
        # Once nobody has it open, vivid plugs itself in again.
        after = play_until(source, lambda: source.stats().n_connects == 2)
        after += play_until(source, lambda: False, 1.0)
        seen["gaps"] = [packet.gap for packet in after if packet.gap]
        seen["frames_after"] = sum(len(packet.frames) for packet in after)
        stamps = [frame.exposure_end_us for packet in packets + after for frame in packet.frames]
        seen["ascend"] = bool((np.diff(stamps) > 0).all())
    unload()
    return seen


def play_until(source: VideoCameraSource, condition: Any, seconds: float = PATIENCE_S) -> list[Any]:
    """The packets until something is so, or for some seconds."""
    packets: list[Any] = []
    deadline = time.monotonic() + seconds
    for packet in source.poll():
        packets += [] if packet is None else [packet]
        if condition() or time.monotonic() > deadline:
            break
    return packets


def until_error(camera: VideoCamera) -> str:
    """Returns the name of the error with which the stream ends; empty after a second."""
    deadline = time.monotonic() + 1.0
    while time.monotonic() < deadline:
        try:
            camera.take(0.5)
        except CameraError as error:
            return type(error).__name__
    return ""
