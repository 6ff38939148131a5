"""A game of the ordinary user: what SDL sees of the pads for some seconds, as JSON."""

import json
import sys
import time

from tests.kernel.guest.sdl import look, open_games


def main() -> None:
    """Looks at the first pad through both generations of SDL."""
    seen: dict[str, dict[str, list[int]]] = {"sdl2": {}, "sdl3": {}}
    deadline = time.monotonic() + float(sys.argv[1])
    with open_games() as games:
        names = {name: game.name.decode() for name, game in games.items()}
        counts = {name: game.n_gamepads for name, game in games.items()}
        while time.monotonic() < deadline:
            for name, game in games.items():
                for control, value in look(game).items():
                    low, high = seen[name].get(control, (0, 0))
                    seen[name][control] = [min(low, value), max(high, value)]
            time.sleep(0.02)
    print(json.dumps({"names": names, "n_gamepads": counts, "seen": seen}))


main()
