"""The things that a person has to buy or find, by property: makers and shops change."""

import csv
from io import StringIO
from typing import NamedTuple

from neurotouch_hid.gel_making.plan import N_LEDS, N_SCREWS, Plan


class Need(NamedTuple):
    """Something that is needed.

    Attributes:
        amount: how many, or how much.
        what: the thing.
        property: what matters of it.
    """

    amount: str
    what: str
    property: str


def list_needs(plan: Plan, silicone_ml: float = 0.0) -> list[Need]:
    """Returns what is needed.

    Args:
        plan: the measures.
        silicone_ml: the volume of a cast skin.
    """
    camera = plan.camera
    needs = [
        Need(
            "1",
            f"camera '{camera.name}'",
            f"{camera.width_px} x {camera.height_px} px, {camera.view_deg:g}° from top to bottom, "
            f"sharp at {plan.distance:.0f} mm from its lens, focus and exposure can be fixed; the "
            "more pictures a second, the better",
        )
    ]
    colours = ("black", "white") if plan.gel.light else ("white", "black")
    match plan.way:
        case "evening":
            size = 2.0 * plan.flange
            needs += [
                Need(
                    "1",
                    f"{colours[0]} silicone baking mat, or a large balloon",
                    f"at least {size:.0f} mm wide, up to 1 mm thick, dull",
                ),
                Need(
                    "1", f"{colours[1]} paint pen", f"dots of {plan.gel.dot_mm:g} mm; try a scrap"
                ),
                Need(
                    "1",
                    "frame such as an embroidery hoop",
                    f"{2.0 * plan.radius + 4.0:.0f} mm or more inside",
                ),
                Need("1", "box or wide pipe", f"carries the frame {plan.distance:.0f} mm up"),
                Need("1", "white lamp on direct current", "inside the box; it must not flicker"),
            ]
            return needs
        case "printed":
            needs.append(
                Need("40 g", "soft filament in two colours", f"{colours[0]} and {colours[1]}, dull")
            )
        case "cast":
            needs += [
                Need(
                    f"{1.3 * silicone_ml:.0f} ml",
                    "silicone that cures by addition (platinum)",
                    "Shore 00-30 to A 10; skin-safe; no cure inhibition by the mould's material",
                ),
                Need("some", f"{colours[0]} and {colours[1]} pigment", "for this silicone"),
                Need("some", "mould release", "for silicone on plastic"),
            ]
    needs += [
        Need("250 g", "firm filament", "dull black, so that the body mirrors no light"),
        Need(str(N_LEDS), "LED, 3 mm", "white, diffuse, 20 mA, about 3.1 V"),
        Need(str(N_LEDS), "resistor", "120 Ω, 0.25 W"),
        Need("1", "USB cable to cut", "5 V, 500 mA"),
        Need(
            "0 or 1", "transistor", "only for a strobe: N-channel MOSFET for gates of 3.3 V, 20 V"
        ),
        Need("0 or 1 each", "resistor", "only for a strobe: 100 Ω and 10 kΩ"),
        Need(str(N_SCREWS + 4), "screw M3 x 10", "cuts its own thread in plastic"),
        Need("4", "washer M3", "under the screws of the camera's plate"),
    ]
    if camera.seat == "straps":
        needs.append(Need("2", "cable tie", "up to 3 mm wide"))
    else:
        needs.append(Need("4", "screw M2 x 8 with nut", "holds the board of the camera"))
    return needs


def write_csv(needs: list[Need]) -> str:
    """Returns the list as a table for a spreadsheet."""
    out = StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(["amount", "what", "property"])
    table.writerows(needs)
    return out.getvalue()
