"""The ``neurotouch`` command: one module a sub-command, which parses, calls and prints."""
