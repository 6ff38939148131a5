"""Starts, runs and ends our process; ``docs/develop/process-tricks.md`` lists the tricks."""
