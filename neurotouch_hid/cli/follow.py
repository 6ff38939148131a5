"""What the line makes of a source, for commands that follow it without a pad."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from neurotouch_hid.messages import Step


def read_steps(
    source: str,
    speed: Literal["recorded", "max"] = "recorded",
    seed: int = 0,
    method: Literal["neurotouch", "paper"] = "neurotouch",
    *,
    profile: str = "default",
    seconds: float | None = None,
) -> Iterator["Step"]:
    """The steps of a source, slice by slice, with the person's own values."""
    from neurotouch_hid.cli.play import prepare_kernels
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile, load_user
    from neurotouch_hid.runtime import Pipeline
    from neurotouch_hid.source import open_source

    mapping, config = load_profile(profile), GestureConfig(method=method)
    with open_source(source, speed=speed, seed=seed) as packets:
        prepare_kernels(mapping, config, source)
        live = speed == "recorded" and not packets.name.startswith("file:")
        pipeline = Pipeline.build(mapping, config, user=load_user(), rig=packets.rig, live=live)
        begin_us: int | None = None
        try:
            for packet in packets:
                step = pipeline.advance(packet)
                yield step
                pipeline.catch_up(step)
                begin_us = packet.t_begin_us if begin_us is None else begin_us
                if seconds is not None and packet.t_end_us - begin_us >= seconds * 1e6:
                    return
        finally:
            pipeline.close()


def is_guided(source: str, speed: Literal["recorded", "max"]) -> bool:
    """True if somebody moves now and can be asked; false of what has been recorded."""
    return speed == "recorded" and not source.startswith("file:")
