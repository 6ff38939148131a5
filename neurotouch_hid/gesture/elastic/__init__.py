"""The method ``neurotouch``: fits fingers to the displacements and decides over time."""

from neurotouch_hid.gesture.elastic.method import ElasticMethod

__all__ = ["ElasticMethod"]
