"""Warming up compiles everything that a run then needs."""

import json
import sys

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, warm_up
from tests.processes import run_command

SOURCES = ("sim:tour", "sim:fast,uvc=60,rolling=12,doubled")
PROGRAM = """
import numba  # with the first kernel that is compiled, those before it would be looked up again
import ast, json, sys
from itertools import islice
from pathlib import Path

import neurotouch_hid
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.process.kernel_cache import Kernel
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, warm_up, warm_up_gestures
from neurotouch_hid.source import open_source
from tests.layouts import HEX

def build(gel=PAPER_GEL):
    return Pipeline.build(load_profile("default"), GestureConfig(), gel=gel)

def find_called(name, module):
    '''The kernels that the functions of a module call in the interpreter.'''
    tree = ast.parse(Path(module.__file__).read_text())
    compiled = {
        inner
        for each in tree.body
        if isinstance(getattr(module, getattr(each, "name", ""), None), Kernel)
        for inner in ast.walk(each)
    }
    for each in ast.walk(tree):
        if isinstance(each, (ast.Name, ast.Attribute)) and each not in compiled:
            value = module
            for part in ast.unparse(each).split("."):
                value = getattr(value, part, None)
            if isinstance(value, Kernel):
                yield value

def is_pipelines(name):
    return name.startswith("neurotouch_hid.") and ".source." not in name

warm_up(build())
modules = [(name, each) for name, each in sys.modules.items() if is_pipelines(name)]
called = {kernel for name, module in modules for kernel in find_called(name, module)}
forgotten = [repr(each) for each in called if not each.n_variants]
late = []
find = Kernel._find
def note(kernel, args):
    if is_pipelines(kernel.__module__):
        late.append(repr(kernel))
    return find(kernel, args)
Kernel._find = note
warm_up_gestures(GestureConfig())  # what a second process compiles is what this one looks for
for name, gel in [(name, gel) for name in sys.argv[1:] for gel in (PAPER_GEL, HEX)]:
    pipeline = build(gel)
    with open_source(name, speed="max", gel=gel) as source:
        for packet in islice(source, 1_200):
            pipeline.advance(packet)
    pipeline.close()
print(json.dumps([len(called), forgotten, late]))
"""


def test_warm_up_takes_a_gel_through_every_stage():
    line = Pipeline.build(load_profile("default"), GestureConfig())
    warm_up(line)
    seen = line.rest.detector.stats()
    assert seen.n_references == 1  # the drawn gel is found, so tracker and gesture have run
    assert line.tracker.stats().n_events > 0


def test_no_kernel_is_loaded_or_compiled_while_a_person_plays():
    """Compiling takes seconds; the pad would wait for it, with what was pressed.

    Another gel needs no kernels of its own.
    """
    done = run_command(sys.executable, "-c", PROGRAM, *SOURCES)
    n_called, forgotten, late = json.loads(done.stdout)
    assert n_called > 30
    assert forgotten == []
    assert late == []
