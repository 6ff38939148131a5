"""A simulated gel under a simulated DAVIS-346: scripts of gestures in, packets and their truth out."""

from neurotouch_hid.source.simulator.simulator import Simulator, SimulatorConfig

__all__ = ["Simulator", "SimulatorConfig"]
