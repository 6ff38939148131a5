"""``neurotouch profile edit``."""

COMMANDS = ()
