"""Prints every gesture of a gel: python read_gel.py [SOURCE], for example driver: or sim:tour."""

import sys

from neurotouch_hid import open_gel

with open_gel(sys.argv[1] if len(sys.argv) > 1 else "sim:push") as gel:
    for touch in gel:
        print(touch.kind, f"{touch.intensity_mm:.1f} mm", touch.contacts_mm.round(1).tolist())
