"""The method ``neurotouch``: fingers fitted to the field, decided over time."""

from neurotouch_hid.gesture.elastic.method import ElasticMethod

__all__ = ["ElasticMethod"]
