"""Plugs an emulated camera in and out while another program listens; prints what that heard.

    LD_PRELOAD=libumockdev-preload.so.0 python -m tests.source.davis.hotplug

Preloaded here, too, or udev's library would not find the device that it is to tell of.
"""

import json
import select
import subprocess
import sys
import time

from neurotouch_devtools.emulator import EmulatedCamera
from neurotouch_devtools.emulator.umockdev import Umockdev

from neurotouch_hid.source.davis.usb import Usb

PATIENCE_S = 100.0
"""The listener's; it does nothing else before."""


def listen():
    watch = Usb().watch()
    while True:
        print("listening", flush=True)
        begun = time.monotonic()
        watch.wait(PATIENCE_S)
        print("heard" if time.monotonic() - begun < PATIENCE_S else "silence", flush=True)


def main():
    said = []
    with Umockdev(EmulatedCamera([])) as cable:
        cable.unplug()
        listener = subprocess.Popen(
            [sys.executable, "-m", "tests.source.davis.hotplug", "listen"],
            env=cable.environment,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
        )
        try:
            for act in (lambda: cable.plug(EmulatedCamera([])), cable.unplug) * 3:
                assert listener.stdout.readline() == "listening\n"
                assert not select.select([listener.stdout], [], [], 0.3)[0]  # not by itself
                act()
                said.append(listener.stdout.readline().strip())
        finally:
            listener.kill()
            listener.wait()
    print(json.dumps(said))


if __name__ == "__main__":
    if sys.argv[1:] == ["listen"]:
        listen()
    else:
        main()
