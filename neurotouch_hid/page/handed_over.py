"""What the page says of saved settings: whether they apply already."""

from neurotouch_hid.errors import DriverError
from neurotouch_hid.handover import hand_over


def hand_over_now(profile: str = "") -> str:
    """Gives what has been saved to the running driver, and tells what became of it.

    Args:
        profile: what has been saved; empty: the person's own values, which always apply.

    Raises:
        DriverError: it goes on with what it had.
    """
    done = hand_over()
    if done.status == "refused":
        raise DriverError(f"Saved, but not in use. {done.text}", hint=done.fix)
    if done.status != "plays":
        return done.text
    if profile and profile not in done.profiles:
        return f"Another profile is active. Choose '{profile}' and press 'Play with it'."
    return "It applies now."
