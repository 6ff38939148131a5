"""Draws regular patterns that are no gel, as a camera on a desk or at a window sees them."""

import math

import cv2
import numpy as np


def _turn(size_px, pitch_px, degrees):
    """Coordinates of each pixel in pitches of a turned pattern, x and y."""
    width, height = size_px
    y, x = np.mgrid[:height, :width].astype(np.float32)
    a = math.radians(degrees)
    u = (math.cos(a) * (x - width / 2) + math.sin(a) * (y - height / 2)) / pitch_px
    v = (math.cos(a) * (y - height / 2) - math.sin(a) * (x - width / 2)) / pitch_px
    return u, v


def _finish(picture, rng, pitch_px):
    """A lens, uneven light and noise, as every picture of a camera has."""
    height, width = picture.shape
    sigma = max(0.03 * pitch_px, 0.4)
    picture = cv2.GaussianBlur(picture.astype(np.float32), (0, 0), sigma)
    y, x = np.mgrid[:height, :width]
    light = 1.0 - 0.25 * np.hypot(x / width - 0.4, y / height - 0.6)
    return np.clip(picture * light + rng.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)


def _dots(u, v, share):
    """1 within dots of a square lattice, whose diameter is ``share`` of the pitch."""
    return (np.hypot(u - np.rint(u), v - np.rint(v)) < share / 2).astype(np.float32)


def draw_plate(size_px, pitch_px, seed=0):
    """A perforated plate before a light, without an end."""
    rng = np.random.default_rng(seed)
    return _finish(20 + 200 * _dots(*_turn(size_px, pitch_px, 4), 0.35), rng, pitch_px)


def draw_shirt(size_px, pitch_px, seed=0):
    """Printed dots on cloth that hangs in soft folds."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 12)
    folds = 0.15 * np.sin(u / 5.0 + 1) + 0.1 * np.sin(v / 7.0)
    return _finish(60 + 150 * _dots(u + folds, v + 0.5 * folds, 0.3), rng, pitch_px)


def draw_hexagons(size_px, pitch_px, seed=0):
    """A perforated plate whose rows are shifted by half of the pitch."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 4)
    v = v / math.sqrt(0.75)
    row = np.rint(v)
    dots = np.hypot(u + 0.5 * row - np.rint(u + 0.5 * row), (v - row) * math.sqrt(0.75)) < 0.18
    return _finish(20 + 200 * dots, rng, pitch_px)


def draw_chessboard(size_px, pitch_px, seed=0):
    """A board of many squares, as those that calibrate cameras."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 3)
    return _finish(30 + 180 * ((np.floor(u) + np.floor(v)) % 2), rng, pitch_px)


def draw_tiles(size_px, pitch_px, seed=0):
    """Light tiles with dark joints."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 2)
    joint = (np.abs(u - np.rint(u)) < 0.06) | (np.abs(v - np.rint(v)) < 0.06)
    return _finish(np.where(joint, 60.0, 190.0), rng, pitch_px)


def draw_keyboard(size_px, pitch_px, seed=0):
    """Rows of keys, each with a light letter, shifted from row to row."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 1)
    row = np.rint(v)
    u = u + 0.25 * (row % 4)
    key = (np.abs(u - np.rint(u)) < 0.42) & (np.abs(v - row) < 0.42)
    letter = np.hypot(u - np.rint(u) + 0.12, v - row + 0.12) < 0.12
    return _finish(np.where(letter, 230.0, np.where(key, 60.0, 25.0)), rng, pitch_px)


def draw_matrix(size_px, pitch_px, seed=0):
    """A panel of 16 x 16 lamps, all alight: it ends, but is no disc."""
    rng = np.random.default_rng(seed)
    u, v = _turn(size_px, pitch_px, 3)
    u, v = u + 0.5, v + 0.5
    panel = (np.abs(u - 0.5) < 8) & (np.abs(v - 0.5) < 8)
    return _finish(15 + 210 * _dots(u, v, 0.3) * panel, rng, pitch_px)


PATTERNS = {
    "plate": draw_plate,
    "shirt": draw_shirt,
    "hexagons": draw_hexagons,
    "chessboard": draw_chessboard,
    "tiles": draw_tiles,
    "keyboard": draw_keyboard,
    "matrix": draw_matrix,
}
