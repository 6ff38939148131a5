"""Event cameras of many makers, through the library ``neuromorphic-drivers``, an optional extra."""
