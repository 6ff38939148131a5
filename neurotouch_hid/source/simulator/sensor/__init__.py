"""The DAVIS-346 as a model: event pixels and frames of a moving picture."""

from neurotouch_hid.source.simulator.sensor.pixel import TICK_US, Sensor, SensorConfig

__all__ = ["TICK_US", "Sensor", "SensorConfig"]
