"""What was compiled is used again, unless it is damaged or anything in it has changed."""

import ctypes
import os
import pickle
import resource
import shutil
import subprocess
import sys
from hashlib import sha256
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import neurotouch_hid
from neurotouch_hid.messages import EVENT_DTYPE
from neurotouch_hid.process import kernel_cache
from neurotouch_hid.process.kernel_cache import Kernel, bind, load
from neurotouch_hid.process.kernel_files import _find_folder
from neurotouch_hid.process.own_command import make_own_command
from neurotouch_hid.process.processor import find_levels, read_abilities
from neurotouch_hid.process.source_stamp import stamp
from neurotouch_hid.tracker.kernels.event_camera import add_events
from tests.processes import run_command

PACKAGE = Path(neurotouch_hid.__file__).parent
COPIED = (
    "__init__.py",
    "partial_file.py",
    "process/__init__.py",
    "process/c_call.py",
    "process/kernel_cache.py",
    "process/kernel_compiler.py",
    "process/kernel_files.py",
    "process/code_loading.py",
    "process/machine_code.py",
    "process/processor.py",
    "process/source_stamp.py",
)
OUTER = """
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.inner import FACTOR, double

@kernel
def call(x):
    return FACTOR * double(x)
"""
INNER = """
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.constants import TWO

FACTOR = 1

@kernel
def double(x):
    return TWO * x
"""
CALL = """
from neurotouch_hid.outer import call
from neurotouch_hid.process.kernel_cache import find_cache_trouble
import sys
value = call(3)
if "numba" in sys.modules:
    how = "linked" if sum(call.dispatcher.stats.cache_hits.values()) else "compiled"
else:
    how = "loaded"
print(value, how, find_cache_trouble())
"""

LOAD = """
import sys
from llvmlite import binding
parse, n_parsed = binding.parse_bitcode, []
binding.parse_bitcode = lambda code: n_parsed.append(1) or parse(code)
from neurotouch_hid.outer import call
assert call(3) == 6
print(
    sum(call.dispatcher.stats.cache_hits.values()),
    len(n_parsed),
    "numba.np.polynomial" in sys.modules,
)
"""
RICH = """
import sys
from threading import Thread
import numpy as np
from neurotouch_hid.rich import Pair, work

def say(function, *args):
    try:
        print(repr(function(*args)))
    except Exception as error:
        print(repr(error))

records = np.zeros(3, np.dtype([("a", "i8"), ("b", "?")], align=True))
records["a"] = 1, 2, 3
say(work, Pair(records, 2), 0.5)
say(work, Pair(records[::2], 2), np.float32(0.5))
say(work, Pair(records, 2), -1.0)

print([each["a"].sum() for each in [records]], "numba" in sys.modules)
import numba
from neurotouch_hid.rich import outer
say(outer, 3)
say(work, Pair(records, 2), 0.5)
"""
RICH_KERNELS = """
from typing import NamedTuple
import numpy as np
from neurotouch_hid.process.kernel_cache import kernel

class Pair(NamedTuple):
    records: np.ndarray
    factor: int

@kernel(error_model="numpy")
def work(pair, x):
    if x < 0:
        raise ValueError("x is negative")
    found = np.empty(len(pair.records))
    for k in range(len(pair.records)):
        found[k] = pair.records[k].a * pair.factor + np.hypot(x, 3.0)
        pair.records[k].b = True
    return found, pair.records[0].a, x > 0

@kernel
def outer(x):
    return x + 1
"""


needs_levels = pytest.mark.skipif(
    len(find_levels(read_abilities())) < 2, reason="needs a processor with x86-64-v3"
)


@pytest.fixture
def copy(tmp_path):
    """A package of the same name, with a kernel that calls another, which has a constant."""
    package = tmp_path / "neurotouch_hid"
    (package / "process").mkdir(parents=True)
    for name in COPIED:
        shutil.copy(PACKAGE / name, package / name)
    for name, text in (("outer", OUTER), ("inner", INNER), ("constants", "TWO = 2\n")):
        (package / f"{name}.py").write_text(text)
    return package


def call_aloud(package, prepare=None, **environment):
    """Returns the value, how the kernel came about, and the sentence of trouble."""
    value, how, trouble = say(CALL, package, prepare, **environment).split(" ", 2)
    return int(value), how, trouble


def say(program, package, prepare=None, command=(), **environment):
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA")}
    done = run_command(
        *command,
        sys.executable,
        "-c",
        program,
        cwd=package.parent,
        env={**inherited, "PYTHONPATH": str(package.parent), **environment},
        preexec_fn=prepare,
    )
    return done.stdout.rstrip("\n")


def call(package, **environment):
    value, how, trouble = call_aloud(package, **environment)
    assert not trouble
    return value, how


def put_into_package(package, level, **environment):
    """Compiles for a level of x86-64, as the making of a package does."""
    chosen = {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": ""}
    assert call(package, **chosen, **environment) == (6, "compiled")
    for path in package.rglob("*.nbc"):
        path.unlink()


def find_kept(package, ending="code"):
    """The compiled outer kernel, which calls the inner one."""
    (path,) = package.rglob(f"outer.call-*.{ending}")
    return path


def test_a_kept_kernel_is_loaded_without_what_compiles(copy):
    assert call(copy) == (6, "compiled")
    assert call(copy) == (6, "loaded")
    find_kept(copy).unlink()
    assert say(LOAD, copy) == "1 0 False"
    assert call(copy) == (6, "loaded")


def test_loaded_code_does_the_same_with_records_tuples_arrays_and_errors(copy):
    (copy / "rich.py").write_text(RICH_KERNELS)
    *compiled, modules, last, again = say(RICH, copy).splitlines()
    assert compiled[0].startswith("(array([5.04")
    assert "5.04" in compiled[1]
    assert compiled[2] == "ValueError('x is negative')"
    assert modules.endswith("True")
    assert (last, again) == ("4", compiled[0])
    (path,) = copy.rglob("rich.outer-*.nbc")
    path.unlink()  # so that numba, imported later, has to compile beside loaded code
    (path,) = copy.rglob("rich.outer-*.code")
    path.unlink()
    *loaded, modules, last, again = say(RICH, copy).splitlines()
    assert loaded == compiled
    assert modules.endswith("False")
    assert (last, again) == ("4", compiled[0])


@pytest.mark.parametrize("is_chosen", [False, True])
def test_an_update_of_what_a_loop_calls_is_not_missed(copy, tmp_path, is_chosen):
    chosen = {"NUMBA_CACHE_DIR": str(tmp_path / "chosen")} if is_chosen else {}
    assert call(copy, **chosen) == (6, "compiled")
    assert call(copy, **chosen) == (6, "loaded")
    (copy / "constants.py").write_text("TWO = 20\n")
    assert call(copy, **chosen) == (60, "compiled")
    (copy / "inner.py").write_text(INNER.replace("FACTOR = 1", "FACTOR = 2"))
    assert call(copy, **chosen) == (120, "compiled")
    assert call(copy, **chosen) == (120, "loaded")
    assert (tmp_path / "chosen").exists() == is_chosen


def test_an_update_may_rename_a_class_that_a_loop_takes(copy):
    named = """
from typing import NamedTuple
from neurotouch_hid.process.kernel_cache import kernel

class Pair(NamedTuple):
    a: int

@kernel
def inner(pair):
    return pair.a
"""
    outer = """
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.inner import Pair, inner

@kernel
def call(x):
    return inner(Pair(x + x))
"""
    (copy / "inner.py").write_text(named)
    (copy / "outer.py").write_text(outer)
    assert call(copy) == (6, "compiled")
    (copy / "inner.py").write_text(named.replace("Pair", "Couple"))
    (copy / "outer.py").write_text(outer.replace("Pair", "Couple"))
    assert call(copy) == (6, "compiled")
    assert call(copy) == (6, "loaded")
    kept = [path.name for path in copy.rglob("*.nbc")]
    assert len(kept) == len({name.split("-")[0] for name in kept}) >= 2  # the old ones are gone


def flip(content, place):
    return content[:place] + bytes([content[place] ^ 0x10]) + content[place + 1 :]


@pytest.mark.parametrize(("ending", "instead"), [("code", "linked"), ("nbc", "compiled")])
def test_what_is_damaged_is_made_again(copy, ending, instead):
    assert call(copy) == (6, "compiled")
    path = find_kept(copy, ending)
    content = path.read_bytes()
    for damaged in (
        b"",
        content[:40],
        content[:-1],
        flip(content, len(content) // 2),
        sha256(b"no pickle").digest() + b"no pickle",
    ):
        path.write_bytes(damaged)
        find_kept(copy).unlink() if ending == "nbc" else None
        assert call(copy) == (6, instead)
    assert path.read_bytes() != damaged
    assert call(copy) == (6, "loaded")


def test_another_kernel_in_the_place_of_one_is_not_used(copy):
    assert call(copy) == (6, "compiled")
    find_kept(copy).unlink()
    (other,) = copy.rglob("inner.double-*.nbc")
    other.replace(find_kept(copy, "nbc"))
    assert call(copy) == (6, "compiled")


def test_code_for_other_types_is_not_used(copy):
    assert say(CALL.replace("call(3)", "call(3.0)"), copy).startswith("6.0 compiled")
    of_float = find_kept(copy)
    assert call(copy) == (6, "compiled")
    (of_int,) = {*copy.rglob("outer.call-*.code")} - {of_float}
    of_int.write_bytes(of_float.read_bytes())
    assert call(copy) == (6, "linked")


def test_another_processor_has_files_of_its_own(copy):
    assert call(copy) == (6, "compiled")
    assert call(copy, NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="") == (6, "compiled")
    assert len([*copy.rglob("outer.call-*.code")]) == 2
    assert call(copy) == (6, "loaded")
    assert call(copy, NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="") == (6, "loaded")


@pytest.mark.parametrize(
    ("change", "how"),
    [("platform.python_version = lambda: '3.99.1'", "loaded"), ("sys.abiflags = 't'", "compiled")],
)
def test_an_update_within_a_minor_version_of_python_compiles_nothing(copy, change, how):
    assert call(copy) == (6, "compiled")
    find_kept(copy, "nbc").unlink()
    said = say(f"import platform, sys; {change}\n{CALL}", copy)
    assert said.split(" ", 2)[:2] == ["6", how]


@needs_levels
def test_code_that_came_with_a_package_is_loaded_by_everybody(copy, tmp_path):
    put_into_package(copy, "x86-64-v2")
    own = tmp_path / "own"
    assert call(copy, NUMBA_CACHE_DIR=str(own)) == (6, "loaded")
    assert not own.exists()
    (copy / "constants.py").write_text("TWO = 20\n")
    assert call(copy, NUMBA_CACHE_DIR=str(own)) == (60, "compiled")
    assert [*own.rglob("outer.call-*.code")]


@needs_levels
def test_code_for_abilities_that_the_processor_lacks_is_not_loaded(copy, tmp_path):
    put_into_package(copy, "x86-64-v3")
    older = tmp_path / "older"
    older.write_text(read_abilities().replace(",0125", ""))  # AVX2
    assert say_of(older, copy).startswith("6 compiled")


@needs_levels
def test_code_for_a_level_is_loaded_from_the_package_alone(copy, tmp_path):
    stranger = {"NUMBA_CACHE_DIR": str(tmp_path / "stranger")}
    put_into_package(copy, "x86-64-v2", **stranger)
    assert [*Path(stranger["NUMBA_CACHE_DIR"]).rglob("outer.call-*.code")]
    assert call(copy, **stranger) == (6, "compiled")


def test_a_service_that_sees_only_processes_in_proc_loads_what_was_compiled(copy):
    """Its unit has ProcSubset=pid, and there is no /proc/cpuinfo."""
    inside = ["unshare", "--user", "--map-root-user", "--mount", "--pid", "--fork", "sh", "-euc"]
    script = 'mount -t proc -o subset=pid proc /proc; ! test -e /proc/cpuinfo; exec "$@"'
    if subprocess.run([*inside, script, "sh", "true"], capture_output=True, check=False).returncode:
        pytest.skip("this machine lets nobody mount")
    assert call(copy) == (6, "compiled")
    assert say(CALL, copy, command=(*inside, script, "sh")).startswith("6 loaded")


def test_on_a_processor_that_nobody_knows_numba_loads_what_was_compiled(copy):
    assert call(copy) == (6, "compiled")
    assert say_of("/nowhere", copy).startswith("6 linked")


def say_of(abilities, package):
    """As if the processor's abilities were those that a file lists."""
    known = "from neurotouch_hid.process import processor\n"
    return say(f"{known}processor._ABILITIES = processor.Path({str(abilities)!r})\n{CALL}", package)


def test_a_folder_in_the_place_of_a_file_only_costs_time(copy):
    assert call(copy) == (6, "compiled")
    kept = find_kept(copy)
    kept.unlink()
    kept.mkdir()
    value, how, trouble = call_aloud(copy)
    assert (value, how) == (6, "linked")
    assert str(kept.parent) in trouble


def test_without_room_all_is_compiled_and_one_sentence_says_so(copy):
    def fill_the_disk():
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))

    value, how, trouble = call_aloud(copy, fill_the_disk, PYTHONDONTWRITEBYTECODE="1")
    assert (value, how) == (6, "compiled")
    assert "cannot be kept in" in trouble
    assert not [each for end in ("partial", "nbc", "code") for each in copy.rglob(f"*.{end}")]


def test_without_any_place_all_is_compiled(copy):
    (copy / "__pycache__").write_text("no folder")
    nowhere = {
        "NUMBA_CACHE_DIR": "/dev/null/chosen",
        "XDG_CACHE_HOME": "/dev/null/personal",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    value, how, trouble = call_aloud(copy, **nowhere)
    assert (value, how) == (6, "compiled")
    assert "/dev/null/chosen" in trouble


def obey_modes():
    """Takes from root the right to write where the mode forbids it; others never had it."""
    pr_capbset_drop, cap_dac_override = 24, 1
    ctypes.CDLL(None).prctl(pr_capbset_drop, cap_dac_override, 0, 0, 0)


def test_what_only_others_may_write_is_still_read(copy):
    assert call(copy) == (6, "compiled")
    folder = copy / "__pycache__"
    folder.chmod(0o555)
    try:
        elsewhere = {"XDG_CACHE_HOME": "/dev/null", "PYTHONDONTWRITEBYTECODE": "1"}
        assert call_aloud(copy, obey_modes, **elsewhere) == (6, "loaded", "")
    finally:
        folder.chmod(0o755)


def test_a_place_relative_to_the_current_folder_is_never_used(copy):
    (copy / "__pycache__").write_text("no folder")
    home = copy.parent / "home"
    call(copy, XDG_CACHE_HOME="somewhere", HOME=str(home), PYTHONDONTWRITEBYTECODE="1")
    assert not (copy.parent / "somewhere").exists()
    assert [*home.glob(".cache/neurotouch/*/outer.call-*.nbc")]


def list_kernels():
    for path in PACKAGE.rglob("kernels/[a-z]*.py"):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        module = import_module(".".join(parts))
        yield from (each for each in vars(module).values() if hasattr(each, "py_func"))


def test_every_kernel_of_ours_is_kept_so():
    kernels = [*list_kernels()]
    assert len(kernels) > 100
    assert all(isinstance(each, Kernel) for each in kernels)


def test_the_stamp_of_a_loop_is_that_of_all_it_imports():
    loops = list(PACKAGE.rglob("kernels/[a-z]*.py"))
    stamps = {path: stamp(path) for path in loops}
    assert len(stamps) > 15
    assert len(set(stamps.values())) == len(stamps)


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """The compiled kernels of a run, in a folder of their own."""
    chosen = tmp_path_factory.mktemp("warm")
    with pytest.MonkeyPatch.context() as patch:
        for kernels in PACKAGE.rglob("kernels"):
            usual = _find_folder(kernels)
            patch.setenv("NUMBA_CACHE_DIR", str(chosen))
            shutil.copytree(usual, _find_folder.__wrapped__(kernels), dirs_exist_ok=True)
            patch.undo()
    play(chosen)
    return chosen


def play(chosen, prepare=None, **environment):
    words = "run --source sim:press --device memory --speed max --seconds 0.2 --show nothing"
    done = run_command(
        *make_own_command(*words.split()),
        env={**os.environ, "NUMBA_CACHE_DIR": str(chosen), **environment},
        preexec_fn=prepare,
    )
    assert "The pad is neutral." in done.stderr
    return done.stderr


def test_a_warm_start_imports_no_compiler_and_nothing_for_recordings_and_plugins(warm):
    told = play(warm, PYTHONPROFILEIMPORTTIME="1")
    imported = {line.rpartition("|")[2].strip() for line in told.splitlines()}
    assert "numpy" in imported
    assert not {"numba", "llvmlite"} & imported
    assert not {"lz4", "xml", "importlib.metadata"} & imported


def test_a_run_mends_a_damaged_cache_without_a_word(warm):
    contents = {path: path.read_bytes() for path in warm.rglob("displacement.displace-*")}
    assert {path.suffix for path in contents} == {".nbc", ".code"}
    for path, content in contents.items():
        path.write_bytes(content[:-100])
    assert "kept" not in play(warm)
    for path, content in contents.items():
        assert len(path.read_bytes()) > len(content) - 100


def test_a_run_without_room_says_once_that_it_compiles_again(warm):
    for path in warm.rglob("displacement.displace-*"):
        path.unlink()
    told = play(warm, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
    assert told.count("cannot be kept") == 1


def test_a_dtype_that_is_made_again_and_again_is_the_same_to_a_kernel():
    """Arrays with fields that come from another process bring such dtypes."""
    net = np.zeros((260, 346), np.float32)
    for _ in range(2):  # the first call may import numba, which then numbers dtypes once more
        add_events(np.zeros(1, EVENT_DTYPE), net)
    n_before = add_events.n_variants
    for _ in range(50):
        add_events(np.zeros(1, pickle.loads(pickle.dumps(EVENT_DTYPE))), net)
    assert add_events.n_variants == n_before <= 2


def test_a_kernel_whose_first_arguments_are_given_takes_the_others_of_any_type():
    events = np.zeros(3, EVENT_DTYPE)
    bound = bind(add_events, events)
    across = np.zeros((346, 260), np.float32).T
    for net in (np.zeros((260, 346), np.float32), across, np.zeros((260, 346), np.float32)):
        events["p"] = ~events["p"]  # what is in an array may change
        bound(net)
        assert net[0, 0] == (3.0 if events["p"][0] else -3.0)
    n_before = add_events.n_variants
    bound(across)
    assert add_events.n_variants == n_before


def test_what_is_loaded_before_its_first_call_is_compiled_by_numba_too(monkeypatch):
    """On a processor that nobody knows numba keeps the code, and usually waits for a call."""
    monkeypatch.setattr(kernel_cache, "_list_levels", list)
    monkeypatch.setattr(kernel_cache, "_describe_machine", lambda: None)
    left_to_numba = Kernel(add_events.py_func, {})
    load(left_to_numba, np.zeros(1, EVENT_DTYPE), np.zeros((260, 346), np.float32))
    assert left_to_numba.dispatcher.signatures
