"""Nuisances of a real room, each alone or mixed: they make a recording harder."""

from neurotouch_hid.source.simulator.nuisances.catalogue import (
    MIXTURES,
    NUISANCES,
    disturb,
    read_nuisances,
)

__all__ = ["MIXTURES", "NUISANCES", "disturb", "read_nuisances"]
