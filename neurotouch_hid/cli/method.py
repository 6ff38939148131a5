"""The option ``--method`` that several commands share."""

import click

choose_method = click.option(
    "--method",
    type=click.Choice(["neurotouch", "paper"]),  # gesture.METHODS, without loading its kernels
    default="neurotouch",
    show_default=True,
    help="How gestures are recognised.",
)
