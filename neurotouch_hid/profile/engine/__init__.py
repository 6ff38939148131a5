"""The parts the mapping is made of, in the order a gesture passes them.

conditioned gesture: orientation, neutral, filter, range, latch, regions
    ─▶ binding runner, one for each binding: threshold ─ debounce ─ level ─ press ─ mode
    ─▶ output: buttons, axes, keys and mouse (response, slew, dwell)
"""
