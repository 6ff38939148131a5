"""Makes a clip of a simulated gel, as a frame camera with a bent lens would see it."""

from dataclasses import replace
from itertools import islice

import cv2
import numpy as np

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.recording import ClipWriter, Picture, labels_path, write_labels
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.scenes import find_scene, scene_config

CANONICAL_MIDDLE = np.array([(SENSOR_WIDTH_PX - 1) / 2, (SENSOR_HEIGHT_PX - 1) / 2])


class Lens:
    """The map from the simulator's picture to that of a larger sensor.

    Args:
        size_px: width and height of the sensor.
        scale: sensor pixels for each of the simulator's.
        rim: change of scale 130 px of the simulator from the middle, as a polynomial has it.
        centre_px: where the gel's middle is; the lens bends about it.
    """

    def __init__(self, size_px, scale, rim=0.0, centre_px=None):
        self.size_px, self.scale, self.rim = size_px, scale, rim
        middle = (np.array(size_px) - 1) / 2 if centre_px is None else np.array(centre_px)
        self.middle = middle

    def to_sensor(self, points):
        off = np.asarray(points, float) - CANONICAL_MIDDLE
        square = (off**2).sum(axis=-1, keepdims=True) / 130**2
        return self.middle + self.scale * off * (1 + self.rim * square)

    def find_table(self):
        """Where each sensor pixel is in the simulator's picture."""
        x, y = np.meshgrid(*(np.arange(size) for size in self.size_px))
        off = (np.stack([x, y], axis=-1) - self.middle) / self.scale
        far = np.hypot(off[..., 0], off[..., 1])
        known = np.linspace(0.0, 300.0, 30_001)
        bent = known * (1 + self.rim * (known / 130) ** 2)
        n = int(np.argmax(np.diff(bent, append=-1.0) <= 0)) + 1  # farther out it turns back
        r = np.interp(far, bent[:n], known[:n], right=1e4)  # black there
        points = CANONICAL_MIDDLE + off * (r / np.maximum(far, 1e-9))[..., None]
        return points.astype(np.float32)


def make_clip(path, scene, lens, *, seconds, frame_us=8_000, seed=0, writer=ClipWriter):
    """Writes a clip and its labels; returns the path."""
    config = scene_config(scene)
    sensor = replace(config.sensor, frame_us=frame_us, exposure_us=min(4_000, frame_us // 2))
    simulator = Simulator(find_scene(scene), replace(config, sensor=sensor), seed=seed)
    table = lens.find_table()
    truths, first_us = [], None
    with writer(path) as clip:
        for packet in islice(simulator, int(seconds * 100)):
            for frame in packet.frames:
                first_us = frame.t_us if first_us is None else first_us
                pixels = cv2.remap(frame.pixels, table, None, cv2.INTER_CUBIC)
                clip.write(Picture(pixels, frame.t_us, frame.t_us))
                truth = simulator.truth(frame.t_us)
                contacts = lens.to_sensor(truth.contacts_px)
                label = replace(truth, t_us=frame.t_us - first_us, contacts_px=contacts)
                truths.append(label)
    write_labels(labels_path(path), truths)
    return path
