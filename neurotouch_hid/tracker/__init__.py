"""Stage 2: turns events and frames into marker positions."""

from neurotouch_hid.tracker.blobs import BlobFinder, Blobs
from neurotouch_hid.tracker.config import TrackerConfig
from neurotouch_hid.tracker.flicker import Flicker
from neurotouch_hid.tracker.gel_finder import GelFinder
from neurotouch_hid.tracker.markers import MarkerTracker, TrackerStats
from neurotouch_hid.tracker.rest import RestDetector, RestStats
from neurotouch_hid.tracker.rest_config import RestConfig

__all__ = [
    "BlobFinder",
    "Blobs",
    "Flicker",
    "GelFinder",
    "MarkerTracker",
    "RestConfig",
    "RestDetector",
    "RestStats",
    "TrackerConfig",
    "TrackerStats",
]
