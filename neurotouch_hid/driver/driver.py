"""The running driver: one object that opens source, pipeline and pad and keeps them together."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import islice
from threading import Event, Timer
from typing import Any, Final, Self

from neurotouch_hid.client import ask_status, is_service_running
from neurotouch_hid.closing import Closing
from neurotouch_hid.device import Device, check_device, open_device
from neurotouch_hid.driver.admission import Guests
from neurotouch_hid.driver.camera_settings import load_camera_config
from neurotouch_hid.driver.check import check_copilot
from neurotouch_hid.driver.chosen import load_chosen
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.driver.pad import open_pad
from neurotouch_hid.driver.people import People, Person
from neurotouch_hid.driver.settings import load_driver_settings
from neurotouch_hid.driver.wiring import Wiring
from neurotouch_hid.errors import (
    AlreadyRunningError,
    CameraError,
    DeviceError,
    DriverError,
    ProfileError,
)
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.process.kernel_cache import find_cache_trouble
from neurotouch_hid.process.realtime import realtime_priority
from neurotouch_hid.profile import Profile, UserSettings, load_profile
from neurotouch_hid.runtime import LoopStats, Pipeline, Tap, run_pipeline, warm_up
from neurotouch_hid.source import Source, open_source
from neurotouch_hid.source.running_driver import NAME as RUNNING_DRIVER
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

_PATIENCE_S: Final = 1.0
"""After this time of loading the person is told why."""
_WARM_SLICES: Final = 5
"""Slices of the simulator up to its first frame."""

Facts = dict[str, Callable[[], Any]]
"""What ``status`` and the page are told beside the state of the pipeline, asked for each time."""


class Driver(Closing):
    """Opens everything that a driver needs and runs it; a context manager.

    ``run`` plays into the pad until the source ends. ``steps`` gives each Step instead, without a
    pad. Everything is released when the block ends, the pad first.

    Args:
        options: what to play, how, and into which pad.
        announce: is told sentences for the person; called from several threads.
        make_source: opens the source instead of ``options.source``, once the control socket is
            there.
        make_device: makes the pad; called as ``open_device`` is.
        guests: says who else may give commands; nobody but the user and root without.
        facts: what ``status`` and the page are told beside the rest.
        people: a service's settings of the people at the machine.

    Attributes:
        source: the open source.
        pipeline: the stages.
        device: the pad.
        profile: the profile at the start.
        taps: read every Step; add your own before ``run``.

    Raises:
        NeuroTouchError: when the block is entered: something cannot be opened. Everything that was
            opened by then is closed.
    """

    source: Source
    pipeline: Pipeline
    device: Device
    profile: Profile
    user: UserSettings | None

    def __init__(
        self,
        options: DriverOptions,
        *,
        announce: Callable[[str], object] = str,  # says nothing
        make_source: Callable[[], Source] | None = None,
        make_device: Callable[..., Device] = open_device,
        guests: Guests | None = None,
        facts: Facts | None = None,
        people: People | None = None,
    ) -> None:
        self.options = options
        self.taps: list[Tap] = []
        self._announce = announce
        self._make_source = make_source or self._open_source
        self._make_device = make_device
        self._guests = guests
        self._facts = facts or {}
        self._people = people
        self._person: Person | None = None
        self._wiring: Wiring | None = None
        self._stop = Event()
        self._closing = ExitStack()

    def __enter__(self) -> Self:
        try:
            self._open()
        except BaseException:
            self.close()
            raise
        return self

    def close(self) -> None:
        """Releases everything, in the opposite order."""
        self._closing.close()

    def compile(self) -> None:
        """Compiles every kernel for this processor, without a pad."""
        self._load()
        self._prepare()
        self._make_source().close()  # which compiles what reads the camera

    def reload(self) -> None:
        """Loads the profile and the person's values again; safe in a signal handler."""
        if self._wiring is not None:
            self._wiring.reload()

    def stop(self) -> None:
        """Ends ``run``, now or as soon as it begins; from any thread."""
        self._stop.set()

    def run(
        self,
        taps: Iterable[Tap] = (),
        *,
        seconds: float | None = None,
        stop: Event | None = None,
        on_round: Callable[[], object] | None = None,
    ) -> LoopStats:
        """Plays until the source ends, ``stop`` is set or the time is up; the pad is neutral then.

        Args:
            taps: read every Step, beside ``self.taps``.
            seconds: ends after so much sensor time.
            stop: ends the loop when it is set.
            on_round: is called after every round of the loop, also one without a slice.

        Raises:
            GelNotFoundError: the source has ended and no frame has shown the gel.
        """
        stop = stop or self._stop
        if self._stop.is_set():  # before the loop begins
            stop.set()
        self._stop = stop
        timed = () if seconds is None else (_stop_after(seconds, stop),)
        session = self._wiring.session if self._wiring is not None else None
        with ExitStack() as stack:
            if self.pipeline.has_frame_thread or session is not None:
                stack.enter_context(realtime_priority())
            every = [*self.taps, *taps, *timed]
            return run_pipeline(
                self.source,
                self.pipeline,
                self.device,
                every,
                stop=stop,
                session=session,
                on_round=on_round,
            )

    def steps(self, *, seconds: float | None = None) -> Iterator[Step]:
        """Gives each Step as it comes; the pad is not written.

        Args:
            seconds: ends after so much sensor time.
        """
        packets = self.source if seconds is None else _cut_off(self.source, seconds)
        for packet in packets:
            step = self.pipeline.advance(packet)
            yield step
            self.pipeline.process_frames(step)

    def _open(self) -> None:
        options, closing = self.options, self._closing
        self._load()
        control = self._listen() if options.is_listening else None
        if self._is_prepared_first():
            self._prepare()
            self.source = closing.enter_context(self._make_source())
        else:
            self.source = closing.enter_context(self._make_source())
            if options.needs_device or options.identity:  # before the kernels compile, and again
                check_device(options.device, options.identity)
            check_copilot(options)
            self._prepare()
        self.pipeline = Pipeline.build(
            self.profile,
            GestureConfig(method=options.method),
            user=self.user,
            rig=self.source.rig,
            frame_thread=options.speed == "recorded"
            and (self.source.is_live or self.source.is_simulated),
        )
        closing.callback(self.pipeline.close)
        if not options.is_listening:
            self.device = closing.enter_context(self._open_bare_device())
            return
        settings = load_driver_settings(options.player)
        try:
            played = open_pad(
                options.device,
                find_extra_devices(self.profile),
                settings,
                identity=options.identity,
                player=options.player,
                copilot=options.copilot,
                shows_rumble=options.shows_rumble,
                wait=options.wait,
                make=self._make_device,
            )
        except DeviceError as error:
            if options.needs_device:
                raise
            self._announce(f"No real controller this time: {error.message} Going on without.")
            played = open_pad("memory", (), settings, player=options.player, copilot="")
        self.device = closing.enter_context(played.device)
        own: Facts = getattr(self.source, "facts", {})
        self._wiring = closing.enter_context(
            Wiring(
                control,
                self.pipeline,
                self.device,
                name=self._profile_name,
                profile=self.profile,
                user=self.user or UserSettings(),
                settings=settings,
                source=self.source,
                player=options.player,
                announce=self._announce,
                facts={**played.facts, **own, **self._facts},
                copilot=played.copilot,
                end=self.stop if self._guests is None else None,
                people=self._people,
                person=self._person,
                default=options.profile,
            )
        )
        self.taps += self._wiring.taps

    def _is_prepared_first(self) -> bool:
        """Returns whether kernels are loaded before the source is opened.

        A camera that is waited for may come meanwhile. Another driver's packets must be taken as
        they come: who takes none for 10 s gets no more.

        Raises:
            NotRunningError: that driver does not run.
        """
        if self.options.source != RUNNING_DRIVER:
            return self.options.wait
        ask_status()
        return True

    def _load(self) -> None:
        """Loads the profile and the values; a service those of the person at the machine.

        Raises:
            ProfileError: they cannot be used; for a service, the machine's cannot.
        """
        options = self.options
        if not options.personal:
            self.user, self._profile_name = None, options.profile or UserSettings().slots[0]
            self.profile = load_profile(self._profile_name)
            return
        if self._people is not None and (person := self._people.find_present()) is not None:
            try:
                chosen = load_chosen(person, options.profile, options.player)
            except ProfileError as error:  # the machine still plays
                self._announce(f"The settings of user {person.uid} cannot be used: {error.message}")
            else:
                self._person = person
                self._profile_name, self.profile, self.user = chosen
                return
        chosen = load_chosen(None, options.profile, options.player)
        self._profile_name, self.profile, self.user = chosen

    def _listen(self) -> ControlSocket | None:
        """Opens the control socket; where none can be made, says so and goes on without.

        Raises:
            AlreadyRunningError: another driver of this player runs.
            DriverError: a service, which nobody sees, has no socket.
        """
        try:
            folder = find_runtime_folder(self.options.player)
            return self._closing.enter_context(ControlSocket(folder, self._guests))
        except AlreadyRunningError:
            raise
        except DriverError as error:
            if self._guests is not None:
                raise
            self._announce(f"Warning: {error.message} 'neurotouch pause' will not work.")
            return None

    def _open_source(self) -> Source:
        """Opens the source of the options.

        Raises:
            AlreadyRunningError: the service has the camera.
            NeuroTouchError: as ``open_source``.
        """
        options = self.options
        try:
            return open_source(
                options.source,
                slice_us=options.slice_us,
                speed=options.speed,
                seed=options.seed,
                camera=load_camera_config(options.player),
                wait=options.wait,
            )
        except CameraError as error:
            from neurotouch_hid.source.davis import find_cameras  # noqa: PLC0415

            if not (find_cameras() and is_service_running()):
                raise
            raise AlreadyRunningError(
                "The neurotouch service is already running, and it has the camera.",
                hint="See what it does: neurotouch status. To play without it: "
                "sudo systemctl stop neurotouch",
            ) from error

    def _open_bare_device(self) -> Device:
        options = self.options
        return self._make_device(
            options.device,
            find_extra_devices(self.profile),
            identity=options.identity,
            player=options.player,
        )

    def _prepare(self) -> None:
        """Loads the kernels, so that no first slice waits for them.

        Of the sources only the simulator has kernels of its own that a first slice needs.
        """
        text = "Loading (the first time compiles for this processor, half a minute) ..."
        with _notice(text, self._announce):
            warm_up(Pipeline.build(self.profile, GestureConfig(method=self.options.method)))
            if find_source_kind(self.options.source) is SourceKind.SIMULATION:
                with open_source(self.options.source, speed="max") as first_slices:
                    for _ in islice(first_slices, _WARM_SLICES):
                        pass
        if trouble := find_cache_trouble():
            self._announce(f"Warning: {trouble}")


def _stop_after(seconds: float, stop: Event) -> Tap:
    """Returns a tap that sets ``stop`` after so much sensor time.

    The loop itself still sees the source, because a live one must go round while it is silent.
    """
    begin_us: int | None = None

    def check(step: Step) -> None:
        nonlocal begin_us
        begin_us = step.packet.t_begin_us if begin_us is None else begin_us
        if step.packet.t_end_us - begin_us >= seconds * 1e6:
            stop.set()

    return check


def _cut_off(packets: Source, seconds: float) -> Iterator[EventPacket]:
    begin_us: int | None = None
    for packet in packets:
        begin_us = packet.t_begin_us if begin_us is None else begin_us
        yield packet
        if packet.t_end_us - begin_us >= seconds * 1e6:
            return


@contextmanager
def _notice(text: str, announce: Callable[[str], object]) -> Iterator[None]:
    timer = Timer(_PATIENCE_S, announce, (text,))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
