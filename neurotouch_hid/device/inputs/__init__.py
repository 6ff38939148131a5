"""Physical devices: a co-pilot's pad, hotkeys on a keyboard, a mouse in use."""
