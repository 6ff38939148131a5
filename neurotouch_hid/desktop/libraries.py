"""Says how the libraries are installed that ask a desktop."""

from neurotouch_hid.players import SERVICE_UNIT


def explain_install(package: str) -> str:
    """Returns how to install a library.

    Where a package of the distribution has brought the service, the system's Python runs it: the
    library comes from there too.

    Args:
        package: its name in Debian.
    """
    if SERVICE_UNIT.exists():
        return f"Install your distribution's package; Debian: sudo apt install {package}"
    return "Install it: pip install 'neurotouch-hid[desktop]'"
