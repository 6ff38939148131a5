"""Writes clips with FFmpeg's own encoders and writers, as other programs do, and reads them so."""

from fractions import Fraction

import av
import numpy as np

US = Fraction(1, 1_000_000)
PACKED = {"yuyv422": 0, "uyvy422": 1}
"""First grey value of a row in formats of two bytes a pixel."""


def draw(k, size_px=(640, 480)):
    """Picture ``k`` of a series, (h, w) uint8: a ramp with a square that moves on."""
    width, height = size_px
    y, x = np.mgrid[:height, :width]
    picture = (40 + 100 * x // width + 60 * y // height).astype(np.uint8)
    at = 16 + 8 * (k % 10)
    picture[at : at + 48, at : at + 48] = 250
    return picture


def write_clip(
    path, pictures, stamps_us, codec="mjpeg", pixels="yuvj420p", *, fps=30, muxer=None, **options
):
    """Writes grey pictures; stamps are kept as exactly as the container can (AVI: numbers)."""
    height, width = pictures[0].shape
    by_number = path.suffix == ".avi"
    base = Fraction(1, fps) if by_number else Fraction(1, 1000) if codec == "mpeg4" else US
    muxer = {"fflags": "+bitexact", **(muxer or {})}
    with av.open(str(path), "w", options=muxer) as container:
        stream = container.add_stream(codec, rate=fps, options=options)
        stream.width, stream.height, stream.pix_fmt = width, height, pixels
        stream.codec_context.time_base = base
        for k, (picture, t_us) in enumerate(zip(pictures, stamps_us, strict=True)):
            frame = av.VideoFrame.from_ndarray(picture, format="gray")
            if pixels != "gray":
                frame = frame.reformat(format=pixels)
            frame.pts, frame.time_base = (k if by_number else round(t_us * US / base)), base
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


def read_by_ffmpeg(path):
    """Returns the grey pictures (h, w) uint8 and their times, µs since the first one."""
    pictures, times = [], []
    with av.open(str(path)) as container:
        for frame in container.decode(video=0):
            times.append((frame.pts if frame.pts is not None else frame.dts) * frame.time_base)
            name = frame.format.name
            if not name.startswith(("gray", "yuv", "nv", *PACKED)) or name.endswith("le"):
                pictures.append(frame.to_ndarray(format="gray"))
                continue
            plane = frame.planes[0]
            rows = np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size)
            step = 2 if name in PACKED else 1
            rows = rows[: frame.height, PACKED.get(name, 0) : frame.width * step : step]
            pictures.append(rows.copy())
    return pictures, [round((t - times[0]) * 1_000_000) for t in times]
