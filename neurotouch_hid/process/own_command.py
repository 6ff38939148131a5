"""Makes the command that starts this program again, however it was installed.

``python -m neurotouch_hid`` finds the package only where Python looks by itself. The Debian package
keeps its libraries in a folder of their own, which only its launcher knows. And Python would look
in the current folder first, where others may have left a ``json.py``.
"""

import sys
from pathlib import Path

_LIBRARIES = Path(__file__).parents[2]
_START = "import sys; sys.path.insert(0, sys.argv.pop(1))\n"
_RUN = 'import runpy; runpy.run_module({!r}, run_name="__main__", alter_sys=True)'


def make_own_command(*arguments: str, module: str = "neurotouch_hid.__main__") -> list[str]:
    """Returns a command that runs a module of this installation with the same Python.

    Args:
        arguments: of the command line, such as ``view``.
        module: the module that runs; by default the ``neurotouch`` command.
    """
    return make_own_python(_RUN.format(module), *arguments)


def make_own_python(code: str, *arguments: str) -> list[str]:
    """Returns a command that runs code with the same Python, which finds this package.

    Args:
        code: the code, without imports from the current folder.
        arguments: of the code.
    """
    safety = "-I" if sys.flags.isolated else "-P"
    return [sys.executable, safety, "-c", _START + code, str(_LIBRARIES), *arguments]
