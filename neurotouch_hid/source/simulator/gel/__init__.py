"""The silicone dome: contact patches in, positions of the markers over time out."""

from neurotouch_hid.source.simulator.gel.motion import KNOT_US, GelConfig, Motion

__all__ = ["KNOT_US", "GelConfig", "Motion"]
