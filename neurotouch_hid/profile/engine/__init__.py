"""The parts the mapping is made of, in the order a gesture passes them.

reading: what the hand does, made ready (orientation, neutral, filter, range, latch, regions)
    ─▶ channel, one for each binding: threshold ─ gate ─ level ─ press ─ mode
    ─▶ output: buttons, axes, keys and mouse (response, slew, dwell)
"""
