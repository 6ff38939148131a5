"""The fingers on the gel, followed from slice to slice by fitting the field they cause."""

from neurotouch_hid.gesture.elastic.hand.hand import Hand, HandConfig

__all__ = ["Hand", "HandConfig"]
