"""The running driver: one object that opens source, pipeline and pad and keeps them together."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from threading import Event
from typing import Self

from neurotouch_hid.client import ask_status
from neurotouch_hid.closing import Closing
from neurotouch_hid.device import Device, check_device, open_device
from neurotouch_hid.driver.admission import Guests
from neurotouch_hid.driver.attachments import Attachments
from neurotouch_hid.driver.check import check_copilot
from neurotouch_hid.driver.chosen import NOTHING, Chosen, choose_first
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.driver.kernel_loading import load_kernels, share_compiling
from neurotouch_hid.driver.last_gel import LastGel
from neurotouch_hid.driver.missing_dots import MissingDots
from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.driver.pad_opening import open_bare_pad, open_driver_pad
from neurotouch_hid.driver.people import People
from neurotouch_hid.driver.settings import load_driver_settings
from neurotouch_hid.driver.source_opening import open_driver_source
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.driver.time_limit import cut_off, stop_after
from neurotouch_hid.errors import (
    AlreadyRunningError,
    DriverError,
    NeuroTouchError,
    require_type,
)
from neurotouch_hid.gel_picture import find_picture
from neurotouch_hid.geometry import Gel
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import Step
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.process.arenas import share_arenas
from neurotouch_hid.process.realtime import realtime_priority
from neurotouch_hid.profile import Profile
from neurotouch_hid.runtime import LoopStats, Pipeline, Tap, run_pipeline
from neurotouch_hid.source import Source
from neurotouch_hid.vocabulary import RUNNING_DRIVER, SourceKind, find_source_kind


class Driver(Closing):
    """Opens everything that a driver needs and runs it; a context manager.

    ``run`` plays into the pad until the source ends. ``steps`` gives each Step instead, without a
    pad. Everything is released when the block ends, the pad first.

    Args:
        options: the source, the profile and the pad.
        announce: is told sentences for the person; called from several threads.
        make_source: opens the source instead of ``options.source``, once the control socket is
            there.
        make_device: makes the pad; called as ``open_device`` is.
        guests: looks up the other users who may give commands; without, only this user and root.
        people: a service's settings of the people at the machine.
        pads: the profile maps the gestures; without, it is not even loaded, ``steps`` gives neutral
            pad states, and there is nothing to ``run``.

    Attributes:
        source: the open source.
        pipeline: the stages.
        device: the pad.
        profile: the profile at the start.
        gel: the gel.
        taps: read every Step; add your own before ``run``.

    Raises:
        TypeError: the options are not ``DriverOptions``.
        NeuroTouchError: when the block is entered: something cannot be opened. Everything that was
            opened by then is closed.
    """

    source: Source
    pipeline: Pipeline
    device: Device
    profile: Profile
    gel: Gel

    def __init__(
        self,
        options: DriverOptions,
        *,
        announce: Callable[[str], object] = str,  # says nothing
        make_source: Callable[[], Source] | None = None,
        make_device: Callable[..., Device] = open_device,
        guests: Guests | None = None,
        people: People | None = None,
        pads: bool = True,
    ) -> None:
        require_type("options", options, DriverOptions, "DriverOptions(source=...)")
        self.options = options
        self.taps: list[Tap] = []
        self._announce = announce
        self._make_source = make_source or self._open_source
        self._make_device = make_device
        self._guests = guests
        self._people = people
        self._has_pads = pads
        self._attachments: Attachments | None = None
        self._stop = Event()
        self._closing = ExitStack()
        self._is_open: bool | None = None  # None: not yet

    def __enter__(self) -> Self:
        if self._is_open is not None:
            raise NeuroTouchError(
                "A driver can be opened only once.", hint="Make another: Driver(options)."
            )
        try:
            self._open()
        except BaseException:
            self.close()
            raise
        self._is_open = True
        return self

    def close(self) -> None:
        """Releases everything, in the opposite order; a second call does nothing."""
        self._is_open = False
        self._closing.close()

    def compile(self) -> None:
        """Compiles every kernel for this processor, without a pad."""
        self._choose()
        with share_compiling(self.options, self.gel):
            self._load_kernels()
            self._make_source().close()  # which compiles what reads the camera

    def reload(self) -> None:
        """Loads the profile and the person's values again; safe in a signal handler."""
        if self._attachments is not None:
            self._attachments.reload()

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
            seconds: ends after this much sensor time.
            stop: ends the loop when it is set.
            on_round: is called after every round of the loop, also one without a slice.

        Raises:
            GelNotFoundError: the source has ended and no frame has shown the gel.
            NeuroTouchError: the driver is not open.
        """
        self._require_open()
        stop = stop or self._stop
        if self._stop.is_set():  # before the loop begins
            stop.set()
        self._stop = stop
        timed = () if seconds is None else (stop_after(seconds, stop),)
        control = self._attachments.control if self._attachments is not None else None
        with ExitStack() as stack:
            if self.pipeline.has_frame_thread or control is not None:
                stack.enter_context(realtime_priority())
            every = [*self.taps, *taps, *timed]
            return run_pipeline(
                self.source,
                self.pipeline,
                self.device,
                every,
                stop=stop,
                control=control,
                on_round=on_round,
            )

    def steps(self, *, seconds: float | None = None) -> Iterator[Step]:
        """Gives each Step as it comes; the pad is not written.

        Args:
            seconds: ends after this much sensor time.

        Raises:
            NeuroTouchError: the driver is not open.
        """
        self._require_open()
        return self._advance(seconds)

    def _advance(self, seconds: float | None) -> Iterator[Step]:
        packets = self.source if seconds is None else cut_off(self.source, seconds)
        advance = self.pipeline.advance if self._has_pads else self.pipeline.recognize
        for packet in packets:
            self._require_open()
            step = advance(packet)
            yield step
            self.pipeline.finish(step)

    def _require_open(self) -> None:
        if not self._is_open:
            raise NeuroTouchError(
                "The driver is not open.",
                hint="Use it inside its block: with Driver(options) as driver: ...",
            )

    def _open(self) -> None:
        options, closing = self.options, self._closing
        share_arenas()
        chosen = self._choose()
        socket = self._listen() if options.is_listening else None
        if self._is_loaded_first():
            self._load_kernels()
            self.source = closing.enter_context(self._make_source())
        else:
            self.source = closing.enter_context(self._make_source())
            if options.needs_device or options.identity:  # before the kernels compile, and again
                check_device(options.device, options.identity)
            check_copilot(options)
            self._load_kernels()
        last = LastGel(options.player) if self._is_camera() else None
        self.pipeline = Pipeline.build(
            self.profile,
            GestureConfig(method=options.method),
            user=chosen.user if options.personal else None,
            rig=self.source.rig,
            near_rad=0.0 if last is None else last.rotation_rad,
            frame_thread=options.speed == "recorded"
            and (self.source.is_live or self.source.is_simulated)
            # A recording gives the same steps at any speed, also one of a simulation.
            and find_source_kind(options.source) is not SourceKind.RECORDING,
            gel=self.gel,
        )
        closing.callback(self.pipeline.close)
        if last is not None:
            closing.callback(lambda: last.remember(self.pipeline.gel))
        self._tell_missing(last)
        if options.is_listening:
            self._attach(chosen, socket)
        else:
            bare = open_bare_pad(options, self.profile, self._make_device)
            self.device = closing.enter_context(bare)

    def _tell_missing(self, last: LastGel | None) -> None:
        """Tells the person of missing dots: those of a camera's gel once, of a recording always."""

        def learn(missing: frozenset[int]) -> frozenset[int]:
            return last.learn_missing(missing, self.source.name, self.gel) if last else missing

        # The service's folders are closed to other people, who then ask the doctor for a picture.
        picture = None if self._people is not None else find_picture("missing-dots.png")
        dots = MissingDots(self._announce, learn, picture)
        self.taps.append(self._closing.enter_context(dots))

    def _is_camera(self) -> bool:
        """Returns whether a gel lies before a camera; of a recording, nothing is remembered."""
        is_recording = find_source_kind(self.options.source) is SourceKind.RECORDING
        return self.source.is_live and not (self.source.is_simulated or is_recording)

    def _attach(self, chosen: Chosen, socket: ControlSocket | None) -> None:
        """Opens the pad with all who play on it, and everything around the pipeline."""
        options, kind = self.options, find_source_kind(self.options.source)
        surroundings = Surroundings(
            announce=self._announce,
            end=self.stop if self._guests is None else None,
            people=self._people,
            default=options.profile,
            player=options.player,
            settings=load_driver_settings(options.player),
            seed=options.seed if kind is SourceKind.SIMULATION else None,
            gel_file=self._gel_file,
        )
        pad = open_driver_pad(
            options,
            self.profile,
            surroundings.settings,
            announce=self._announce,
            make=self._make_device,
        )
        self.device = self._closing.enter_context(pad.device)
        self._attachments = self._closing.enter_context(
            Attachments(socket, self.pipeline, self.source, pad, chosen, surroundings)
        )
        self.taps += self._attachments.taps

    def _is_loaded_first(self) -> bool:
        """Returns whether kernels are loaded before the source is opened.

        A camera that is waited for may come meanwhile. Another driver's packets must be taken as
        they come: who takes none loses the oldest.

        Raises:
            NotRunningError: that driver does not run.
        """
        if self.options.source != RUNNING_DRIVER:
            return self.options.wait
        ask_status()
        return True

    def _choose(self) -> Chosen:
        chosen = NOTHING
        if self._has_pads:
            chosen = choose_first(self.options, self._people, self._announce)
        self.profile = chosen.profile
        options = self.options
        self.gel, self._gel_file = choose_gel(
            options.gel, options.source, options.player, personal=options.personal
        )
        return chosen

    def _open_source(self) -> Source:
        return open_driver_source(self.options, self.gel)

    def _load_kernels(self) -> None:
        load_kernels(self.options, self.profile, self.gel, self._announce)

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
