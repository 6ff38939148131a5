"""Long benchmarks, which a player never needs."""
