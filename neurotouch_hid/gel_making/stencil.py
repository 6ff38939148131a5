"""The flat stencil in its true size, with a ruler to check the printer."""

from typing import Final

from neurotouch_hid.gel_making.plan import Plan
from neurotouch_hid.gel_making.sheet import Circle, Path, Sheet, Words

MIDDLE: Final = (105.0, 115.0)
"""Where the middle of the gel is on the page, mm."""
RULER: Final = (80.0, 215.0, 50.0)
"""Where the ruler begins, and its length, mm."""
_A4: Final = (210.0, 297.0)


def draw_stencil(plan: Plan) -> Sheet:
    """Returns the stencil, seen from the camera's side, on which the dots are painted."""
    sheet = Sheet(*_A4, f"Stencil of the gel {plan.gel.name}, 1:1")
    x, y = MIDDLE
    sheet.add(
        Words(x, 22.0, f"Stencil: gel '{plan.gel.name}', {plan.gel.n_markers} dots", 6.0, "middle"),
        Words(
            x, 30.0, "Print at 100 %. Then measure the ruler: it must be 50 mm long.", 4, "middle"
        ),
        Words(x, 36.0, "You look at the side of the skin that the camera sees.", 4.0, "middle"),
        Circle(x, y, plan.flange, 0.2, dash=True),
        Circle(x, y, plan.radius, 0.3),
    )
    for side in (-1.0, 1.0):
        far = plan.flange + 3.0
        sheet.line((x + side * plan.radius, y), (x + side * far, y), width=0.2)
        sheet.line((x, y + side * plan.radius), (x, y + side * far), width=0.2)
    sheet.add(
        Words(x, y + plan.flange + 9.0, "the user's side", 4.0, "middle"),
        *(
            Circle(x - px, y - py, 0.5 * plan.gel.dot_mm, 0.15)  # seen from below: x is mirrored
            for px, py in plan.points.tolist()
        ),
        Words(x, y + plan.flange + 17.0, _describe(plan), 4.0, "middle"),
    )
    _draw_ruler(sheet)
    sheet.add(
        Words(x, 240.0, "Nobody has built this yet. How to tell us: README.html", 4.0, "middle")
    )
    return sheet


def _describe(plan: Plan) -> str:
    gel = plan.gel
    colour = "light dots on a dark skin" if gel.light else "dark dots on a light skin"
    return (
        f"Dots {gel.dot_mm:g} mm wide, {gel.pitch_mm:.3g} mm apart; {colour}. "
        f"Inner circle {2 * plan.radius:.4g} mm."
    )


def _draw_ruler(sheet: Sheet) -> None:
    x, y, length = RULER
    sheet.add(Path(((x, y), (x + length, y)), 0.3))
    for mm in range(int(length) + 1):
        tick = 5.0 if mm % 10 == 0 else 3.5 if mm % 5 == 0 else 2.0
        sheet.line((x + mm, y), (x + mm, y - tick), width=0.15)
    for mm in range(0, int(length) + 1, 10):
        sheet.add(Words(x + mm, y + 5.0, f"{mm}", 4.0, "middle"))
    sheet.add(Words(x + length + 6.0, y + 1.0, "mm", 4.0))
