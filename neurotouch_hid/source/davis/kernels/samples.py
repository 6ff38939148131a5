"""Compiled loops that read the samples of a frame, a column of pixels at a time."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

TOO_BRIGHT = 384  # a reset value below this is one that the light has already pulled down
WHITE = 1023
BLOCK = 32  # words that are looked at together


@kernel
def count_alike(words: NDArray[np.uint16], i: int) -> int:
    """Returns how many words have the code of word ``i``, from it to the next other one."""
    end, code = i, words[i] >> 12
    while end + BLOCK <= len(words):
        other = 0
        for k in range(BLOCK):
            other |= words[end + k] ^ (code << 12)
        if other >> 12:
            break
        end += BLOCK
    while end < len(words) and words[end] >> 12 == code:
        end += 1
    return end - i


@kernel
def keep_reset(
    samples: NDArray[np.uint16], shift: int, at: int, step: int, reset: NDArray[np.int16]
) -> None:
    """Writes the values before the exposure.

    Args:
        samples: (n,) uint16, readings of one column.
        shift: they are shifted left by so many bits.
        at: the first pixel, ``y * width + x``.
        step: from a pixel to the next one.
        reset: (height * width,) int16, written.
    """
    if step == 1:
        line = reset[at : at + len(samples)]
        for k in range(len(samples)):
            line[k] = (samples[k] & 0x3FF) << shift
        return
    for k in range(len(samples)):
        reset[at + k * step] = (samples[k] & 0x3FF) << shift


@kernel
def draw(
    samples: NDArray[np.uint16],
    shift: int,
    at: int,
    step: int,
    reset: NDArray[np.int16],
    pixels: NDArray[np.uint8],
) -> None:
    """Draws the light, from the values before and after the exposure.

    Args:
        samples: (n,) uint16, readings of one column after it.
        shift: they are shifted left by so many bits.
        at: the first pixel, ``y * width + x``.
        step: from a pixel to the next one.
        reset: (height * width,) int16, the values before it.
        pixels: (height * width,) uint8, written.
    """
    if step == 1:
        line, before = pixels[at : at + len(samples)], reset[at : at + len(samples)]
        for k in range(len(samples)):
            line[k] = _find_light(before[k], (samples[k] & 0x3FF) << shift)
        return
    for k in range(len(samples)):
        at_k = at + k * step
        pixels[at_k] = _find_light(reset[at_k], (samples[k] & 0x3FF) << shift)


@kernel
def _find_light(before: int, value: int) -> int:
    """Returns a pixel's grey value from its values before and after the exposure."""
    light = WHITE if before < TOO_BRIGHT or value == 0 else max(before - value, 0)
    return min(255, (light + 3) >> 2)  # as the vendor's library rounds
