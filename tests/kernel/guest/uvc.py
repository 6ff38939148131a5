"""Plugs emulated UVC cameras into the guest's USB; v4l2-ctl tells what the kernel makes of them."""

import multiprocessing
import re
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cache, partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from evdev.ecodes import EV_ABS
from neurotouch_devtools.emulator import Fault, UsbIp
from neurotouch_devtools.emulator.uvc import (
    Film,
    Mode,
    PixelFormat,
    UvcCamera,
    UvcConfig,
    UvcIdentity,
)

from neurotouch_hid.client import ask as ask_driver
from neurotouch_hid.errors import DriverError
from neurotouch_hid.source import open_source
from neurotouch_hid.source.video.live import VideoCameraSource, VideoStats
from neurotouch_hid.tracker.gel_finder import GelFinder
from tests.kernel.guest.driver import started
from tests.kernel.guest.sdl import look, open_games

NODES = Path("/sys/class/video4linux")
PATIENCE_S = 120.0
N_READ = 20
PLAY_S = 180.0
"""Four times the length of the film, as the slower camera shows it."""
PICTURES_PER_S = {"plug": 10, "plug a slower one": 3}
"""Of the camera whose pictures are played: what a guest without KVM can carry, and one that is busy
besides. The film was taken with 31 pictures a second, so it is seen in slow motion."""
SLOWLY = 5_000_000
"""100 ns from picture to picture."""
MOST_MARKERS = 170
N_MOVES = 2
FAR = 8_000
N_TAKEN = 10
"""Pictures; the kernel has a buffer for each, so that a slow reader loses none."""
N_FILM = 10 * N_TAKEN
"""A camera that does not wait is far ahead when a failed transfer has emptied the buffers."""
FAULT_AT = 4
FAULTS = (
    "dropped+4x2",
    "doubled+4",
    "error+4",
    "damaged+4",
    "protocol@stream+12",
    "unplug@picture+4",
)
"""Three transfers make a picture of 320x240."""
WITHOUT = frozenset({"gain", "focus", "autofocus", "power_line_frequency"})
CAPTURED = re.compile(r"seq: +(\d+) bytesused: (\d+) ts: ([\d.]+)")


def describe(_: Path) -> dict[str, Any]:
    """What v4l2-ctl says of a camera with everything, and of a poorer one on USB 2."""
    seen = {}
    poor = UvcIdentity(
        super_speed=False,
        serial=None,
        product="Poor camera",
        modes=(Mode(PixelFormat.MJPEG, 640, 480, (333_333,)),),
        without=WITHOUT,
    )
    for name, identity in {"full": UvcIdentity(), "poor": poor}.items():
        with plugged(UvcCamera(make_film(), UvcConfig(identity))) as node:
            seen[name] = {
                "info": ask(node, "--info"),
                "formats": ask(node, "--list-formats-ext"),
                "controls": ask(node, "--list-ctrls-menus"),
            }
            if name == "full":
                seen["set"] = [
                    ask(node, *change)
                    for change in (
                        ("--set-ctrl=exposure_time_absolute=40",),
                        ("--set-ctrl=auto_exposure=1",),
                        ("--set-ctrl=exposure_time_absolute=40", "--get-ctrl=auto_exposure"),
                        ("--set-ctrl=brightness=-20", "--get-ctrl=brightness"),
                    )
                ]
                seen["got"] = ask(node, "--get-ctrl=exposure_time_absolute,brightness,gain")
    wait_for(lambda: not list_nodes())
    return {**seen, "log": read_log("uvcvideo")}


def take_pictures(_: Path) -> dict[str, Any]:
    """Takes pictures in every format."""
    seen = {}
    for pixel_format in PixelFormat:
        with plugged(UvcCamera(make_film(), UvcConfig(unpaced=True))) as node:
            seen[pixel_format.value] = capture(node, pixel_format)
    return seen


def suffer(_: Path) -> dict[str, Any]:
    """Takes pictures of a camera with each fault."""
    seen = {}
    for fault in FAULTS:
        camera = UvcCamera(make_film(), UvcConfig(unpaced=True), [Fault.parse(fault)])
        with plugged(camera) as node:
            seen[fault] = capture(node, PixelFormat.GREY)
            if fault.startswith("unplug"):
                wait_for(lambda: not list_nodes())
    with plugged(UvcCamera(make_film(), UvcConfig(unpaced=True), [Fault.parse("damaged+4")])) as n:
        seen["damaged MJPG"] = capture(n, PixelFormat.MJPEG)
    wait_for(lambda: not list_nodes())
    return seen


def read(results: Path) -> dict[str, Any]:
    """Reads a camera through our source, and counts on both sides."""
    camera = make_gel(results, PICTURES_PER_S["plug"])
    n_read = 0
    with plugged(camera), open_source("video:", finder=GelFinder()) as source:
        deadline = time.monotonic() + PATIENCE_S
        for packet in source.poll():
            n_read += 0 if packet is None else len(packet.frames)
            if n_read >= N_READ or time.monotonic() > deadline:
                break
        stats = finish(source, partial(slow_down, camera), camera.end)
        return {
            "n_sent": camera.n_sent,
            "n_shown": n_read,
            "n_read": stats.n_pictures,
            "n_lost": stats.n_lost + stats.n_damaged,
            "n_not_sent": camera.n_lost,
            "settings": camera.controls.values,
            "exposure_us": stats.exposure_us,
            "mode": str(stats.mode),
            "fps": stats.fps,
            "latency_us": stats.latency_us,
        }


def play(results: Path) -> dict[str, Any]:
    """Plays a camera into the pad, unplugs it in the middle, and plugs it in again."""
    ours, theirs = multiprocessing.Pipe()
    cameras = multiprocessing.get_context("fork").Process(target=serve, args=(theirs, results))
    cameras.start()
    try:
        plug = "plug"
        tell(ours, plug)
        wait_for(list_nodes)
        with started("spacecraft", "video:", "--rate", "25") as (process, reader):
            wait_for(lambda: count_markers() > MOST_MARKERS, every_s=0.5)
            with open_games() as games:
                before = tell(ours, "count"), ask_driver("status")
                seen: dict[str, list[int]] = {}
                watch(games["sdl2"], seen)
                if count_moves(seen) < N_MOVES:
                    tell(ours, "unplug")
                    wait_for(lambda: not list_nodes())
                    plug = "plug a slower one"
                    tell(ours, plug)
                    watch(games["sdl2"], seen)
                after = tell(ours, "count"), ask_driver("status")
                with suppress(TimeoutError):  # the tests say what is wrong
                    reader.wait_for(is_pressed, PATIENCE_S / 2)
                tell(ours, "unplug")
                reader.wait_until_quiet(3.0, PATIENCE_S)
                n_unplugged = len(reader.events)
                status = ask_driver("status")
                tell(ours, plug)
                with suppress(TimeoutError):
                    reader.wait_for(lambda events: is_pressed(events[n_unplugged:]), PATIENCE_S)
            process.terminate()
        return {
            **reader.report(),
            "exit_code": process.exitcode,
            "n_unplugged": n_unplugged,
            "sdl2": seen,
            "before": before,
            "after": after,
            "status": status,
        }
    finally:
        cameras.kill()


def finish(
    source: VideoCameraSource, slow_down: Callable[[], object], end: Callable[[], object]
) -> VideoStats:
    """Ends the stream while the source keeps up, and returns what it has counted.

    Of pictures for which there was no buffer, the kernel tells only by the number of the next one.
    So the last pictures come slowly.
    """
    slow_down()
    n_enough = source.stats().n_pictures + 4
    wait_for(lambda: source.stats().n_pictures >= n_enough)
    end()
    time.sleep(0.5)  # for what is on its way
    return source.stats()


def slow_down(camera: UvcCamera) -> None:
    """Lets a camera send two pictures a second."""
    if camera.agreement is not None:
        camera.agreement = replace(camera.agreement, interval=SLOWLY)


def serve(orders: Connection, results: Path) -> None:
    """Holds the other end of the cable, in a process that the driver does not slow down."""
    while True:
        order = orders.recv()
        if order in PICTURES_PER_S:
            camera = make_gel(results, PICTURES_PER_S[order])
            cable = UsbIp(camera)
        elif order == "unplug":
            cable.close()
        elif order == "slow down":
            slow_down(camera)
        elif order == "end":
            camera.end()
        orders.send([camera.n_sent, camera.n_lost])


def tell(orders: Connection, order: str) -> Any:
    """Gives an order to the camera's process; returns how many pictures were sent, and lost."""
    orders.send(order)
    if not orders.poll(PATIENCE_S):
        raise TimeoutError(f"the camera's process does not answer to {order}")
    return orders.recv()


def make_gel(results: Path, pictures_per_s: int) -> UvcCamera:
    """A camera that sees the gestures, as slow as the guest is."""
    interval = 10_000_000 // pictures_per_s
    film = Film(np.load(results / "film.npy"), period_us=interval // 10)
    mode = Mode(PixelFormat.GREY, 320, 240, (interval,))
    return UvcCamera(film, UvcConfig(UvcIdentity(modes=(mode,))))


def count_markers() -> int:
    """How many markers the driver sees."""
    try:
        return int(ask_driver("status")["markers_tracked"])
    except DriverError:  # it is still starting
        return 0


def watch(game: Any, seen: dict[str, list[int]]) -> None:
    """Notes how far each control of a game is moved, until enough of them were moved far."""
    deadline = time.monotonic() + PLAY_S
    while count_moves(seen) < N_MOVES and time.monotonic() < deadline:
        time.sleep(0.25)
        for control, value in look(game).items():
            low, high = seen.get(control, (0, 0))
            seen[control] = [min(low, value), max(high, value)]


def count_moves(seen: dict[str, list[int]]) -> int:
    """How many controls were moved far."""
    return sum(max(-low, high) > FAR for low, high in seen.values())


def is_pressed(events: list[tuple[int, int, int]]) -> bool:
    """Whether a stick is far from its middle."""
    return any(kind == EV_ABS and abs(value) > FAR for kind, _, value in list(events)[-5:])


@cache
def make_film() -> Film:
    """Pictures of 320x240 that are told from each other, smooth enough for a JPEG."""
    rng = np.random.default_rng(3)
    coarse = rng.integers(256, size=(N_FILM, 15, 20)).astype(np.uint8)
    return Film(np.stack([cv2.resize(picture, (320, 240)) for picture in coarse]))


@contextmanager
def plugged(camera: UvcCamera) -> Iterator[str]:
    """The node of a camera, which is in the guest's USB so long."""
    wait_for(lambda: not list_nodes())
    with UsbIp(camera):
        wait_for(list_nodes)
        node = f"/dev/{min(list_nodes())}"
        wait_for(Path(node).exists)
        yield node


def capture(node: str, pixel_format: PixelFormat) -> dict[str, Any]:
    """Pictures as v4l2-ctl has them: number, time, place in the film, and how far they are off."""
    data = Path("/dev/shm/pictures")
    data.unlink(missing_ok=True)
    said = ask(
        node,
        f"--set-fmt-video=width=320,height=240,pixelformat={pixel_format}",
        *(f"--stream-mmap={N_TAKEN + 2}", f"--stream-count={N_TAKEN}", f"--stream-to={data}"),
        "--verbose",
    )
    frames = [
        (int(number), int(size), float(t_s)) for number, size, t_s in CAPTURED.findall(said["said"])
    ]
    content = data.read_bytes()
    ends = np.cumsum([size for _, size, _ in frames], dtype=int)
    pieces = [content[end - size : end] for end, (_, size, _) in zip(ends, frames, strict=True)]
    # With two processors, uvcvideo may finish a picture before the one that came first.
    order = sorted(range(len(frames)), key=lambda k: (frames[k][0], not frames[k][1]))
    frames, pieces = [frames[k] for k in order], [pieces[k] for k in order]
    film = make_film().pictures
    known = {picture.tobytes(): k for k, picture in enumerate(film)}
    lumas = [read_luma(piece, pixel_format) for piece in pieces]
    return {
        "code": said["code"],
        "numbers": [number for number, _, _ in frames],
        "times": [t_s for _, _, t_s in frames],
        "found": [known.get(luma.tobytes(), -1) for luma in lumas],
        "errors": [
            round(cv2.norm(film[number % N_FILM], luma, cv2.NORM_L1) / luma.size, 2)
            for (number, _, _), luma in zip(frames, lumas, strict=True)
            if luma.size
        ],
        "whole": len(content) == sum(map(len, pieces)),
    }


def read_luma(data: bytes, pixel_format: PixelFormat) -> Any:
    """The brightness of a picture of 320x240; empty if it is none."""
    raw = np.frombuffer(data, np.uint8)
    if pixel_format is PixelFormat.MJPEG:
        picture = cv2.imdecode(raw, cv2.IMREAD_GRAYSCALE) if len(raw) else None
        return raw[:0] if picture is None else picture
    if pixel_format is PixelFormat.YUYV:
        raw = np.ascontiguousarray(raw[::2])
    return raw[: 320 * 240].reshape(240, 320) if len(raw) >= 320 * 240 else raw[:0]


def ask(node: str, *options: str) -> dict[str, Any]:
    """What v4l2-ctl says, and its exit code."""
    done = subprocess.run(
        ["v4l2-ctl", "--device", node, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return {"said": done.stdout, "code": done.returncode}


def list_nodes() -> list[str]:
    """The nodes of cameras; those for what comes beside the pictures are left out."""
    found = []
    for index in NODES.glob("*/index"):
        with suppress(OSError):  # it has just gone
            found += [index.parent.name] if index.read_text() == "0\n" else []
    return found


def read_log(word: str) -> list[str]:
    """Lines of the kernel's log."""
    lines = subprocess.run(["dmesg"], capture_output=True, text=True, check=True).stdout
    return [line.partition("] ")[2] for line in lines.splitlines() if word in line]


def wait_for(condition: Any, every_s: float = 0.05) -> None:
    """Asks again and again, seldom where the answer is dear."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError
        time.sleep(every_s)
