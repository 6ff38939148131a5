"""Each trick is still needed: whoever sees one of these fail may delete the trick."""

import sys

from tests.processes import run_command

PREPARED = "from neurotouch_hid.process.startup import *; "


def say(program, prefix=""):
    done = run_command(
        sys.executable,
        "-c",
        prefix + program,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": ":".join(sys.path)},
    )
    return done.stdout.strip()


def test_numba_loads_scipy_unless_it_is_left_out():
    program = (
        "import numba; from numba import njit; "
        "njit(lambda x: x)(1); import sys; print(bool(sys.modules.get('scipy')))"
    )
    assert say(program) == "True", "numba no longer loads SciPy: leave_out_scipy may go"
    assert say(program, PREPARED + "leave_out_scipy(); ") == "False"


def test_evdev_loads_asyncio_unless_it_is_left_out():
    program = "import sys, evdev; evdev.InputDevice; print('ssl' in sys.modules)"
    assert say(program) == "True", "evdev loads no asyncio: leave_out_asyncio may go"
    assert say(program, PREPARED + "leave_out_asyncio(); ") == "False"


def test_a_started_driver_has_loaded_neither_asyncio_nor_opencv():
    program = (
        "import sys; sys.argv[1:] = 'run --source sim:rest --speed max --device memory --seconds "
        "0.1 --show nothing'.split()\n"
        "from neurotouch_hid.__main__ import main\n"
        "try:\n    main()\nexcept SystemExit:\n"
        "    print({'asyncio', 'ssl', 'cv2', 'evdev'} & {*sys.modules})"
    )
    assert say(program) == "{'evdev'}"


def test_a_profile_compiles_its_model_and_those_of_no_part():
    program = (
        "from neurotouch_hid.profile import Mapping, load_profile\n"
        "from neurotouch_hid.profile.schema import Strict\n"
        "Mapping(load_profile('default'))\n"
        "def find(model):\n"
        "    for part in model.__subclasses__():\n"
        "        yield part; yield from find(part)\n"
        "print(*sorted(each.__name__ for each in find(Strict) if each.__pydantic_complete__))"
    )
    assert say(program) == "Profile UserSettings"


def test_what_shares_out_an_evaluation_has_loaded_neither_driver_nor_simulator():
    program = (
        "import sys, neurotouch_hid.evaluation.accuracy as _; loaded = {*sys.modules}\n"
        "print({f'neurotouch_hid.{each}' for each in ('runtime', 'source.simulator')} & loaded)"
    )
    assert say(program) == "set()"


def test_a_process_of_a_pool_loads_no_asyncio_either(tmp_path):
    (tmp_path / "look.py").write_text(
        "import sys\ndef look():\n    import evdev; return 'asyncio' in sys.modules\n"
    )
    program = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import look\n"
        "from neurotouch_hid.process.own_pool import open_pool\n"
        "if __name__ == '__main__':\n"
        "    with open_pool(1) as pool:\n        print(pool.submit(look.look).result())"
    )
    assert say(program) == "False"


def test_the_processes_of_a_pool_share_what_was_imported_for_them(tmp_path):
    (tmp_path / "look.py").write_text(
        "import os\nloaded_by = os.getpid()\ndef look(): return loaded_by, os.getpid()\n"
    )
    program = (
        f"import os, sys; sys.path.insert(0, {str(tmp_path)!r}); import look\n"
        "os.environ['PYTHONPATH'] = os.pathsep.join(sys.path)\n"
        "from neurotouch_hid.process.own_pool import open_pool\n"
        "if __name__ == '__main__':\n"
        "    seen = []\n"
        "    for _ in range(2):\n"
        "        with open_pool(1, modules=['look']) as pool:\n"
        "            seen.append(pool.submit(look.look).result())\n"
        "    print(seen[0][0] == seen[1][0] != look.loaded_by, len({own for _, own in seen}))"
    )
    assert say(program) == "True 2"


def test_ctrl_c_while_a_pool_starts_ends_it_without_a_traceback(tmp_path):
    """In a terminal it reaches every process: the server while it imports, the others later."""
    (tmp_path / "look.py").write_text(
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
        "def look(): os.kill(os.getpid(), signal.SIGINT)\n"
    )
    program = (
        "import os, sys\n"
        f"os.environ['PYTHONPATH'] = os.pathsep.join([{str(tmp_path)!r}, *sys.path])\n"
        "from neurotouch_hid.process.own_pool import open_pool\n"
        "from concurrent.futures.process import BrokenProcessPool\n"
        "if __name__ == '__main__':\n"
        "    with open_pool(1, modules=['look']) as pool:\n"
        "        sys.path.insert(0, os.environ['PYTHONPATH'].split(os.pathsep)[0])\n"
        "        try:\n"
        "            pool.submit(eval, '__import__(\"look\").look()').result()\n"
        "        except BrokenProcessPool:\n            print('ended')\n"
    )
    done = run_command(sys.executable, "-c", program)
    assert done.stdout == "ended\n"
    assert "Traceback" not in done.stderr


def test_processes_of_a_pool_work_with_a_long_temporary_folder(tmp_path):
    """Its path and a name of Python's are the address of a socket, which is short."""
    folder = tmp_path / ("long" * 25)
    folder.mkdir()
    program = (
        "import os\n"
        "from neurotouch_hid.process.own_pool import open_pool\n"
        "if __name__ == '__main__':\n"
        "    with open_pool(1) as pool:\n        print(pool.submit(abs, -7).result())"
    )
    assert say(f"import os; os.environ['TMPDIR'] = {str(folder)!r}\n{program}") == "7"


def test_numba_starts_colorama_unless_it_is_left_out(tmp_path):
    """As Debian's python3-colorama does: its start writes to the terminal at the end."""
    (tmp_path / "colorama.py").write_text(
        "__version__ = '0.4.6'\nreinit = deinit = print\n"
        "class Any:\n    def __getattr__(self, name): return ''\nFore = Style = Any()\n"
        "def init(): print('started')\n"
    )
    program = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from numba.core import errors\n"
        "try:\n    errors.ColorShell()\nexcept AttributeError:\n    pass\nprint('end')"
    )
    assert "started" in say(program), "numba starts no colorama: leave_out_colours may go"
    assert say(program, PREPARED + "leave_out_colours(); ") == "end"


def test_python_looks_for_garbage_while_it_loads_unless_told_otherwise():
    program = (
        "import gc; import numpy, pydantic; import neurotouch_hid.profile.schema.profile; "
        "print(sum(each['collections'] for each in gc.get_stats()))"
    )
    often, rarely = int(say(program)), int(say(program, PREPARED + "collect_rarely(); "))
    assert often > 20, "Python looks for garbage rarely by itself: collect_rarely may go"
    assert rarely < often / 5


def test_pydantic_looks_for_plugins_unless_it_is_hastened():
    program = "import sys, pydantic; pydantic.create_model('A', a=(int, 0)); print({})"
    looked = program.format("'importlib.metadata' in sys.modules")
    disabled = PREPARED + "leave_out_pydantic_plugins(); "
    assert say(looked, disabled) == "True", "pydantic no longer looks: hasten_pydantic may go"
    assert say(looked, disabled + "hasten_pydantic(); ") == "False"
