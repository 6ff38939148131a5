"""Runs the line: builds the stages, turns the crank, keeps the pad safe."""

from neurotouch_hid.runtime.broadcast import Broadcast
from neurotouch_hid.runtime.camera import load_camera_config
from neurotouch_hid.runtime.commands import SAID, Commands
from neurotouch_hid.runtime.companions import find_companions
from neurotouch_hid.runtime.control import ControlSocket
from neurotouch_hid.runtime.garbage import short_collections
from neurotouch_hid.runtime.lookout import Lookout
from neurotouch_hid.runtime.loop import LoopStats, Tap, run_line
from neurotouch_hid.runtime.pad import PlayedPad, open_pad
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.priority import hurry
from neurotouch_hid.runtime.reload import ProfileWatch
from neurotouch_hid.runtime.seat import find_seated_users
from neurotouch_hid.runtime.service import ServiceSettings, load_service_settings
from neurotouch_hid.runtime.session import Session
from neurotouch_hid.runtime.settings import DriverSettings, load_driver_settings
from neurotouch_hid.runtime.signals import stop_on_signals
from neurotouch_hid.runtime.stopwatch import Stopwatch
from neurotouch_hid.runtime.supervisor import Supervisor
from neurotouch_hid.runtime.warmup import warm_up

__all__ = [
    "SAID",
    "Broadcast",
    "Commands",
    "ControlSocket",
    "DriverSettings",
    "Lookout",
    "LoopStats",
    "Pipeline",
    "PlayedPad",
    "ProfileWatch",
    "ServiceSettings",
    "Session",
    "Stopwatch",
    "Supervisor",
    "Tap",
    "find_companions",
    "find_seated_users",
    "hurry",
    "load_camera_config",
    "load_driver_settings",
    "load_service_settings",
    "open_pad",
    "run_line",
    "short_collections",
    "stop_on_signals",
    "warm_up",
]
