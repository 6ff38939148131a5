"""What the page says of saved settings: whether they apply already."""

from neurotouch_hid.errors import DriverError
from neurotouch_hid.handover import hand_over


def hand_over_now() -> str:
    """Gives what has been saved to the running driver, and tells what became of it.

    Raises:
        DriverError: it goes on with what it had.
    """
    done = hand_over()
    if done.status == "refused":
        raise DriverError(f"Saved, but not in use. {done.text}", hint=done.fix)
    return "It applies now." if done.status == "plays" else done.text
