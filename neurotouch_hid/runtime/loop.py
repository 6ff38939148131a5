"""The loop around the pipeline: source in, device out, neutral when anything is wrong."""

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from neurotouch_hid.device import Device
from neurotouch_hid.gel_sentences import require_gel
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.pipeline_control import PipelineControl
from neurotouch_hid.runtime.stall_guard import LIVE_STALL_S, STALL_PERIODS, STALL_S, StallGuard
from neurotouch_hid.source import ActivityAware, Periodic, PolledSource, Troubled

Tap = Callable[[Step], None]
"""Reads Steps and never feeds back."""


@dataclass(frozen=True, slots=True)
class LoopStats:
    """The slices, events and sensor time that a run has processed, and its host time."""

    slices: int
    events: int
    sensor_s: float
    host_s: float


def run_pipeline(
    source: Iterable[EventPacket],
    pipeline: Pipeline,
    device: Device,
    taps: Iterable[Tap] = (),
    *,
    stop: threading.Event | None = None,
    control: PipelineControl | None = None,
    on_round: Callable[[], object] | None = None,
) -> LoopStats:
    """Drives the pad until the source ends or ``stop`` is set; the pad is neutral afterwards.

    Commands of ``control`` are applied between two slices. While a polled source has nothing, the
    loop goes round all the same, so that it takes commands and can end.

    Args:
        source: gives the packets.
        pipeline: the stages.
        device: the pad.
        taps: read every Step.
        stop: ends the loop.
        control: takes commands for the pipeline.
        on_round: is called after every round of the loop, also one without a slice.

    Raises:
        GelNotFoundError: the source ended and no frame showed the gel.
    """
    taps = tuple(taps)
    polled: Iterable[EventPacket | None] = source
    stall_s = STALL_S
    if isinstance(source, PolledSource):
        polled, stall_s = source.poll(), LIVE_STALL_S
    aware = source if pipeline.has_frame_thread and isinstance(source, ActivityAware) else None
    periodic = source if isinstance(source, Periodic) else None
    troubled = source if isinstance(source, Troubled) else None
    slices = events = 0
    first_us = last_us = None
    begun = time.perf_counter()
    try:
        with StallGuard(device, stall_s) as guard:
            for packet in polled:
                if control is not None:
                    control.apply_commands()
                if packet is not None and packet.is_partial:
                    pipeline.advance_partial(packet)
                elif packet is not None:
                    # A recording gives the same Steps, however slow this machine is.
                    if guard.take_silence() and pipeline.has_frame_thread:
                        pipeline.mapping.release()
                    step = pipeline.advance(packet)
                    begun_ns = time.perf_counter_ns()
                    device.write(step.pad)
                    pipeline.timings.device.end(begun_ns)
                    if periodic is not None:
                        guard.stall_s = max(stall_s, STALL_PERIODS * periodic.period_s)
                    guard.feed()
                    if control is not None:
                        control.record(step)
                    for tap in taps:
                        tap(step)
                    pipeline.finish(step)
                    if aware is not None:
                        aware.set_activity(
                            is_idle=pipeline.is_idle, wants_frames=not pipeline.is_at_rest
                        )
                    slices += 1
                    events += len(packet.events)
                    first_us = packet.t_begin_us if first_us is None else first_us
                    last_us = packet.t_end_us
                elif troubled is not None and troubled.trouble:
                    guard.give_up()
                if on_round is not None:
                    on_round()
                if stop is not None and stop.is_set():
                    break
    finally:
        device.neutral()
        pipeline.close()
    if stop is None or not stop.is_set():
        require_gel(pipeline.gel, is_told=getattr(source, "rig", None) is not None)
    sensor_s = 0.0 if first_us is None or last_us is None else (last_us - first_us) / 1e6
    return LoopStats(slices, events, sensor_s, time.perf_counter() - begun)
