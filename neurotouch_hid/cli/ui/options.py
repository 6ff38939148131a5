"""Options that several commands share, so that they are called and mean the same everywhere."""

import click

METHODS = ("neurotouch", "paper")  # gesture.METHODS, without loading its kernels

method_option = click.option(
    "--method",
    type=click.Choice(METHODS),
    default=METHODS[0],
    show_default=True,
    help="How gestures are recognised.",
)
profile_option = click.option(
    "--profile",
    show_default="the first of your favourites",
    help="Name or path of a profile.",
)
source_option = click.option(
    "--source",
    default="davis:",
    show_default=True,
    help="davis: (the camera), file:NAME.aedat4 (a recording) or sim:NAME (the simulator).",
)
speed_option = click.option(
    "--speed",
    type=click.Choice(["recorded", "max"]),
    default="recorded",
    show_default=True,
    help="As recorded, or as fast as possible; then nothing waits for a person.",
)
seed_option = click.option(
    "--seed", default=0, show_default=True, help="Seed of whatever is simulated."
)
seconds_option = click.option(
    "--seconds", type=click.FloatRange(min=0.1), help="End by itself after so long."
)
rate_option = click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(min=25.0, max=1000.0),
    metavar="HZ",
    show_default="250 of a camera, 100 (the paper's) of anything else",
    help="Gestures a second: more answer sooner and cost more processor time.",
)
