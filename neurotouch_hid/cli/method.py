"""The methods by name, and the option ``--method`` that several commands share."""

import click

METHODS = ("neurotouch", "paper")  # gesture.METHODS, without loading its kernels

choose_method = click.option(
    "--method",
    type=click.Choice(METHODS),
    default=METHODS[0],
    show_default=True,
    help="How gestures are recognised.",
)
