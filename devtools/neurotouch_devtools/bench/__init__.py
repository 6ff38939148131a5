"""Long benchmarks for developers."""
