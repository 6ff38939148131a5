"""How fast each stage and the whole pipeline are on this machine."""
