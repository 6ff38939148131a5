"""The emulated camera and the long benchmarks of neurotouch_hid."""
