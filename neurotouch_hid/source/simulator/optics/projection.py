"""Projects markers to the image: perspective of the dome, lens, rig, brightness."""

import math

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.source.simulator.config import CameraConfig

_RING_MM = 1.5  # the housing hides everything further out
_DARKNESS = 0.93  # share of the light that a dark marker takes
_FLAT_MM = 1e-3  # a lower dome is flat


def find_ring(gel: Gel) -> float:
    """Returns the radius of the housing's hole in mm."""
    return gel.radius_mm + _RING_MM


class CameraModel:
    """Maps points of the gel to the image.

    Attributes:
        rig: where the gel is in the image.
    """

    def __init__(self, config: CameraConfig, gel: Gel = PAPER_GEL) -> None:
        self._config, self._gel = config, gel
        self.rig = config.rig
        height_mm = max(config.height_mm, _FLAT_MM)
        self._sphere_mm = (gel.radius_mm**2 + height_mm**2) / (2.0 * height_mm)

    def project(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns image points (n, 2) px of gel points (n, 3): x, y, depth below the dome in mm."""
        _, magnified = self._magnify(points_mm)
        return self._config.rig.to_px(magnified)

    def outline(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the appearance of markers in the image.

        Args:
            points_mm: (n, 3) x, y and depth below the dome in mm.

        Returns:
            (n, 6) float64: x, y px, the quadratic form (xx, xy, yy) of the outline in 1/px²,
            brightness 0..1, negative of dark markers.
        """
        scale, magnified = self._magnify(points_mm)
        r = np.hypot(points_mm[:, 0], points_mm[:, 1])
        height = self._dome(r) - points_mm[:, 2]
        tilt = np.arcsin(np.clip(r / self._sphere_mm, 0.0, 1.0))
        view = np.arctan2(r, self._config.distance_mm + height)
        facing = np.maximum(np.cos(tilt - view), 0.05)
        angle = np.arctan2(points_mm[:, 1], points_mm[:, 0]) + self._config.rig.rotation_rad
        cos, sin = np.cos(angle), np.sin(angle)
        across = 1.0 / (0.5 * self._gel.dot_mm * self._config.rig.px_per_mm * scale) ** 2
        along = across / facing**2
        hidden = np.clip((find_ring(self._gel) - r) / 1.0, 0.0, 1.0)
        return np.column_stack(
            [
                self._config.rig.to_px(magnified),
                along * cos**2 + across * sin**2,
                (along - across) * cos * sin,
                along * sin**2 + across * cos**2,
                (1.0 if self._gel.light else -_DARKNESS) * facing**self._config.falloff * hidden,
            ]
        )

    def _magnify(
        self, points_mm: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        config = self._config
        r = np.hypot(points_mm[:, 0], points_mm[:, 1])
        height = self._dome(r) - points_mm[:, 2]
        plan = points_mm[:, :2]
        if config.tilt_rad:
            cos, sin = math.cos(config.tilt_rad), math.sin(config.tilt_rad)
            x = cos * plan[:, 0] + sin * height
            height = cos * height - sin * plan[:, 0]
            plan = np.column_stack([x, plan[:, 1]])
            r = np.hypot(x, plan[:, 1])
        depth = config.distance_mm + height
        scale = (config.distance_mm + config.height_mm) / depth
        scale *= 1.0 - config.barrel * (r * scale) ** 2
        if config.fisheye_rad:  # an equidistant lens: as far from the middle as the angle is large
            far = np.maximum(r * scale * math.tan(config.fisheye_rad) / self._gel.radius_mm, 1e-9)
            scale *= np.arctan(far) / far
        return scale, plan * scale[:, None]

    def _dome(self, r: NDArray[np.float64]) -> NDArray[np.float64]:
        sagitta = self._sphere_mm - self._config.height_mm
        return np.sqrt(np.maximum(self._sphere_mm**2 - r**2, 0.0)) - sagitta
