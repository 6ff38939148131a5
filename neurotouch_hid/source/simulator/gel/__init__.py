"""The silicone dome: contact patches in, positions of the markers over time out."""

from neurotouch_hid.source.simulator.config import ELASTICITIES, Elasticity, GelConfig
from neurotouch_hid.source.simulator.gel.motion import KNOT_US, FieldMotion, GelMotion

__all__ = ["ELASTICITIES", "KNOT_US", "Elasticity", "FieldMotion", "GelConfig", "GelMotion"]
