"""Emulated cameras, long benchmarks, the public data set and ``make paper``."""
