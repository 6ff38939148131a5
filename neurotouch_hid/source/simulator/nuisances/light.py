"""Light that changes: LEDs by PWM, mains lamps, a lamp switched on, the sun, a hand's shadow."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.simulator.knot import Knot
from neurotouch_hid.source.simulator.nuisances.stream import frames
from neurotouch_hid.source.simulator.setup import Lamp, Setup
from neurotouch_hid.source.strobe.config import StrobeConfig

Floats = NDArray[np.float64]
Wave = Callable[[Floats], Floats]
"""Returns values between -1 and 1 at times in µs."""

MAINS_HZ = 100.0  # twice the 50 Hz of the mains
DUTY = 0.5  # share of a PWM period in which the LEDs are on
TICK_US = 500.0  # the light is averaged over the sensor's ticks
LAMP_AT, LAMP_US = 0.3, 20_000  # when a lamp is switched on, share of the play; and how fast
CLOUD_US = 3_000_000  # from sun to cloud and back
SHADOW_US = 250_000  # how fast a hand comes
SHADOW_EDGE_PX = 25.0
AWAY_PX = 400.0  # from the middle of the picture to a hand that is not there
SHADOW_PX = 60.0  # how far it reaches beyond the fingers


def mains(setup: Setup, percent: float) -> Setup:
    """Lets all light flicker at 100 Hz, ``percent`` % from the lowest to the highest."""
    return setup.plus(lamps=_flicker(_sine(MAINS_HZ), 0.01 * percent))


def mains_leak(setup: Setup, percent: float) -> Setup:
    """Sends mains light through the gel, from none to ``percent`` % of a white dot, at 100 Hz."""
    return setup.plus(lamps=_leak(_sine(MAINS_HZ), 0.01 * percent))


def pwm(setup: Setup, percent: float) -> Setup:
    """Switches ``percent`` % of all light off and on, 200 times a second."""
    return setup.plus(lamps=_flicker(_square(200.0), 0.01 * percent))


def pwm_fast(setup: Setup, percent: float) -> Setup:
    """Switches ``percent`` % of all light off and on, 900 times a second."""
    return setup.plus(lamps=_flicker(_square(900.0), 0.01 * percent))


def pwm_leak(setup: Setup, percent: float) -> Setup:
    """Sends light of an LED lamp through the gel, ``percent`` % of a white dot, at 200 Hz."""
    return setup.plus(lamps=_leak(_square(200.0), 0.01 * percent))


def strobe(setup: Setup, ms: float) -> Setup:
    """Switches the LED ring off for ``ms`` ms, 20 times a second; the camera sends no frames."""

    def dark_us(t_us: Floats) -> Floats:
        periods, rest_us = np.divmod(t_us, 1e6 / StrobeConfig().hz)
        return np.asarray(1e3 * ms * periods + np.clip(rest_us, 0.0, 1e3 * ms))

    def light(t_us: Floats) -> tuple[Floats, Floats]:
        dark = (dark_us(t_us) - dark_us(t_us - TICK_US)) / TICK_US
        return 1.0 - dark, np.zeros(len(t_us))

    return frames(setup.plus(lamps=light), 0.0)


def lamp(setup: Setup, percent: float) -> Setup:
    """Switches a lamp on after a third of the play: all light grows by ``percent`` %."""
    return setup.plus(lamps=_brighten(setup, 0.01 * percent))


def lamp_leak(setup: Setup, percent: float) -> Setup:
    """Switches a lamp on whose light comes through the gel: ``percent`` % of a white dot."""
    at_us = LAMP_AT * setup.duration_us

    def leak(t_us: Floats) -> tuple[Floats, Floats]:
        return np.ones(len(t_us)), 0.01 * percent * np.clip((t_us - at_us) / LAMP_US, 0.0, 1.0)

    return setup.plus(lamps=leak)


def sun(setup: Setup, percent: float) -> Setup:
    """Sends sunlight through the gel, 0 to ``percent`` % of a white dot; clouds pass in 3 s."""
    phase = setup.random("sun").uniform(0.0, 2.0 * math.pi)

    def leak(t_us: Floats) -> tuple[Floats, Floats]:
        share = 0.5 - 0.5 * np.cos(2.0 * math.pi * t_us / CLOUD_US + phase)
        return np.ones(len(t_us)), 0.01 * percent * share

    return setup.plus(lamps=leak)


def shadow(setup: Setup, percent: float) -> Setup:
    """Lets each hand take ``percent`` % of the light below it, from before it touches."""
    from_rad = setup.random("shadow").uniform(0.25, 0.75) * math.pi  # from the user's side
    strokes = setup.strokes
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX].astype(np.float32)
    rig = setup.config.camera.rig
    x, y = x - rig.centre_px[0], y - rig.centre_px[1]
    flat = (x * math.cos(from_rad) + y * math.sin(from_rad)).ravel()
    period_us = setup.script.duration_us

    def cast(t_us: int, _knot: Knot) -> NDArray[np.float32]:
        t_us = t_us % period_us if setup.script.endless else t_us
        near = 0.0
        for stroke in strokes:
            coming = (t_us - stroke.start_us + SHADOW_US) / SHADOW_US
            leaving = (stroke.end_us + SHADOW_US - t_us) / SHADOW_US
            near = max(near, min(coming, leaving, 1.0))
        edge = -SHADOW_PX + (1.0 - near) * AWAY_PX  # the hand comes in from outside of the picture
        dark = 1.0 / (1.0 + np.exp(np.clip((edge - flat) / SHADOW_EDGE_PX, -30.0, 30.0)))
        return np.asarray(1.0 - 0.01 * percent * dark, np.float32)

    return setup.plus(shades=cast)


def vignetting(setup: Setup, percent: float) -> Setup:
    """Loses ``percent`` % of the light in the corners of the picture, as a wide lens does."""
    return setup.configured("light", vignetting=0.01 * percent)


def ring(setup: Setup, percent: float) -> Setup:
    """Mirrors the LED ring in the gel, as a soft ring ``percent`` % as bright as a white dot."""
    return setup.configured("light", ring_glare=0.01 * percent)


def uneven(setup: Setup, percent: float) -> Setup:
    """Makes one side of the gel brighter than the other, by ``percent`` % of the mean."""
    return setup.configured("light", uneven=0.01 * percent)


def pale(setup: Setup, times: float) -> Setup:
    """Leaves a white dot only ``times`` times as bright as the gel around it."""
    return setup.configured("light", white_dn=times * setup.config.light.black_dn)


def _sine(hz: float) -> Wave:
    """Returns a wave between -1 and 1, its mean over each tick."""
    half = math.pi * hz * TICK_US * 1e-6
    damping = math.sin(half) / half

    def wave(t_us: Floats) -> Floats:
        return damping * np.sin(2e-6 * math.pi * hz * (t_us - 0.5 * TICK_US))

    return wave


def _square(hz: float) -> Wave:
    """Returns a square wave between -1 and 1, its mean over each tick."""
    period_us = 1e6 / hz

    def on_us(t_us: Floats) -> Floats:
        whole, rest = np.divmod(t_us, period_us)
        return DUTY * period_us * whole + np.minimum(rest, DUTY * period_us)

    def wave(t_us: Floats) -> Floats:
        return 2.0 * (on_us(t_us) - on_us(t_us - TICK_US)) / TICK_US - 1.0

    return wave


def _flicker(wave: Wave, size: float) -> Lamp:
    def light(t_us: Floats) -> tuple[Floats, Floats]:
        return 1.0 + 0.5 * size * wave(t_us), np.zeros(len(t_us))

    return light


def _leak(wave: Wave, size: float) -> Lamp:
    def light(t_us: Floats) -> tuple[Floats, Floats]:
        return np.ones(len(t_us)), size * (0.5 + 0.5 * wave(t_us))

    return light


def _brighten(setup: Setup, share: float) -> Lamp:
    at_us = LAMP_AT * setup.duration_us

    def light(t_us: Floats) -> tuple[Floats, Floats]:
        return 1.0 + share * np.clip((t_us - at_us) / LAMP_US, 0.0, 1.0), np.zeros(len(t_us))

    return light
