"""The first meeting with a camera, with a scripted person before simulated rigs."""

import csv
import io
import json
import os
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from neurotouch_hid.doctor.hello.answers import Word, answer_all, compare
from neurotouch_hid.doctor.hello.archive import make_report, write_archive
from neurotouch_hid.doctor.hello.session import PROMPTS, Session
from neurotouch_hid.driver.gel_settings import load_gel_file
from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.messages import Step
from neurotouch_hid.profile import load_profile
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import Script, sequence
from neurotouch_hid.source.simulator.strokes import push, twist
from neurotouch_hid.vocabulary import SourceKind

_REST_US = 6_600_000
_GAP_US = 1_300_000
_ASKED = ("light", "rest", "push_right", "twist_cw")
"""The others are made in the same way."""


def make_script() -> Script:
    return sequence("hello", push(0.0, 7.0), twist(0.5), rest_us=_REST_US, gap_us=_GAP_US)


def play(config: SimulatorConfig, seed: int = 3) -> Iterator[Step]:
    """Plays the script to a rig; the person makes what it says."""
    pipeline = Pipeline.build(load_profile("default"), GestureConfig())
    with Simulator(make_script(), config, seed=seed) as source:
        for packet in source:
            step = pipeline.advance(packet)
            yield step
            pipeline.process_frames(step)


def meet(config: SimulatorConfig) -> Session:
    """Lets a scripted person follow the prompts: Enter once each movement is over."""
    script = make_script()
    done_us = [500_000, _REST_US - 100_000]
    done_us += [stroke.end_us + _GAP_US - 100_000 for stroke in script.strokes]
    session = Session(
        make_plan(load_gel_file(None).settings),
        "sim",
        [prompt for prompt in PROMPTS if prompt.key in _ASKED],
    )
    for step in play(config):
        session.take(step)
        if done_us and step.packet.t_end_us >= done_us[0]:
            done_us.pop(0)
            assert session.missing == "", session.prompt
            session.next()
    session.finish()
    return session


@cache
def meet_usual() -> Session:
    return meet(SimulatorConfig())


@cache
def meet_other() -> Session:
    """A rig with planted differences: more noise, turned, smaller, and a gel that keeps 3 %."""
    usual = SimulatorConfig()
    rig = Rig((172.5, 129.5), 2.0, 0.3)
    return meet(
        replace(
            usual,
            gel=replace(usual.gel, residue=0.03),
            camera=replace(usual.camera, rig=rig),
            sensor=replace(usual.sensor, shot_hz=4.0, leak_hz=0.4),
        )
    )
