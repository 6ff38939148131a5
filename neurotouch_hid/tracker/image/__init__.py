"""What the tracker sees in a frame: bright blobs, and the marker lattice among them."""

from neurotouch_hid.tracker.image.blobs import BlobConfig, BlobFinder, Blobs

__all__ = ["BlobConfig", "BlobFinder", "Blobs"]
