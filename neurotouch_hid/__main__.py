"""``python -m neurotouch_hid`` is the same as the ``neurotouch`` command."""

from neurotouch_hid.cli.main import main

if __name__ == "__main__":
    main()
