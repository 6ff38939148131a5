"""A soft gel with printed dots, seen by an event camera, becomes a standard game controller."""

__version__ = "0.1.0"
