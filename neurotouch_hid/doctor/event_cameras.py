"""Checks event cameras of other makers: which there are, and how well one sends its events."""

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.events.enumeration import find_event_cameras
from neurotouch_hid.source.events.library import INSTALL, load_library
from neurotouch_hid.source.events.models import DAVIS
from neurotouch_hid.source.events.plugged import needs_library
from neurotouch_hid.source.events.source import EventsStats


def check_event_cameras() -> Finding:
    """Lists the event cameras of other makers, and says whether this person may open them."""
    try:
        library = load_library()
    except CameraError:
        if not needs_library():
            return skip("No event camera of another maker is plugged in.")
        return warn(
            "An event camera is plugged in that needs the package neuromorphic-drivers.",
            "Install it.",
            INSTALL,
        )
    cameras = [info for info in find_event_cameras(library) if info.model is not DAVIS]
    if not cameras:
        return skip("No event camera of another maker is plugged in.")
    usable = [info for info in cameras if not info.reason]
    if not usable:
        return warn(
            f"The event camera {cameras[0]} cannot be used: {cameras[0].reason}.",
            "End the program that has it, or install its library's rules and plug it in again.",
            "sudo neuromorphic-drivers-install-udev-rules",
        )
    names = ", ".join(map(str, usable))
    return approve(
        f"Plugged in: {names}. Such cameras were only tried in simulations. To check one with a "
        f"gel: neurotouch doctor --source {usable[0].source}"
    )


def judge_events(source: str, stats: EventsStats, seconds: float) -> Finding:
    """Judges the events of a camera that has just played.

    Args:
        source: its name.
        stats: what it counted.
        seconds: how long it played, by its own clock.
    """
    if not seconds or not stats.n_events:
        reason = f" {stats.trouble}" if stats.trouble else ""
        return fail(f"No events from {source}.{reason}", "Unplug it and plug it in again.")
    sentence = (
        f"{source}: {stats.info}, {stats.n_events / seconds:,.0f} events/s, of which the picture "
        f"of the gel gets {stats.n_shown / seconds:,.0f}; lost {stats.n_lost} times, old data "
        f"thrown away {stats.n_cleared} times, {1e-6 * stats.limited_us:.1f} s at the limit."
    )
    if stats.n_lost or stats.n_cleared:
        return warn(sentence, "Close other programs; use a USB 3 socket and cable.")
    if stats.limited_us:
        return warn(sentence, "Less light that flickers, or less sensitive biases in camera.yaml.")
    return approve(sentence)
