"""Turns Ctrl-C, SIGTERM and SIGHUP into an orderly end of the line."""

import signal
import threading


def stop_on_signals() -> threading.Event:
    """From now on a signal sets the returned event and does nothing else; twice is harmless.

    Nothing puts the former behaviour back: the pad is to be released undisturbed. Only the main
    thread may call this.
    """
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: stop.set())
    return stop
