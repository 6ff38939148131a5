"""The page for the maker: what to print and buy, how to put it together, what to tell us."""

from collections.abc import Sequence
from html import escape
from typing import Final

from neurotouch_hid.gel_making.drawings import draw_cut, draw_dots, draw_wiring
from neurotouch_hid.gel_making.part_drawing import draw_part
from neurotouch_hid.gel_making.parts import Part
from neurotouch_hid.gel_making.plan import TRAVEL_MM, Plan
from neurotouch_hid.gel_making.sheet import Sheet
from neurotouch_hid.gel_making.shopping import Need

_STYLE: Final = """
@page { margin: 15mm; }
body { font: 11pt/1.45 Helvetica, Arial, sans-serif; color: #000; background: #fff;
  max-width: 180mm; margin: 8mm auto; padding: 0 4mm; }
h1 { font-size: 20pt; } h2 { font-size: 14pt; margin-top: 9mm; break-after: avoid; }
.untested { border: 1mm solid #000; padding: 3mm 5mm; }
table { border-collapse: collapse; width: 100%; } tr, figure { break-inside: avoid; }
th, td { border: 0.3mm solid #000; padding: 1mm 2mm; text-align: left; vertical-align: top; }
th { background: #e6e6e6; }
figure { margin: 4mm 0; } figcaption { font-size: 10pt; }
svg { max-width: 100%; max-height: 95mm; height: auto; }
li { margin: 1.5mm 0; } code { font-size: 10pt; }
"""

_TITLES: Final = {
    "evening": "A first evening: a flat gel from the kitchen",
    "printed": "A printed dome",
    "cast": "A cast dome",
}
_OTHERS: Final = {
    "evening": "A flat gel from a baking mat or a balloon, a white pen and a paper stencil.",
    "printed": "A dome from a printer with two colours of soft filament.",
    "cast": "A silicone dome from a printed mould: softest, nearest to the paper's.",
}


def write_page(plan: Plan, parts: Sequence[Part], needs: Sequence[Need]) -> str:
    """Returns the page, HTML with its drawings in it.

    Args:
        plan: the measures.
        parts: what is printed.
        needs: what is bought.
    """
    gel, name = plan.gel, escape(plan.gel.name)
    high = f"{plan.height:g} mm high" if plan.height else "flat"
    lines = [
        "<!doctype html>",
        '<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>Make the gel {name}</title><style>{_STYLE}</style></head><body><main>",
        f"<h1>{_TITLES[plan.way]}</h1>",
        f"<p>Gel “{name}”: {gel.n_markers} dots of {gel.dot_mm:g} mm, {gel.pitch_mm:.3g} mm "
        f"apart, {2 * plan.radius:.4g} mm wide, {high}. Camera "
        f"“{escape(plan.camera.name)}”, {plan.distance:.0f} mm below.</p>",
        '<section class="untested"><h2 style="margin-top:0">Nobody has built this yet</h2>',
        "<p>A program has drawn all of this, and programs have checked it. No person has made it. "
        "Materials, hardness and light are guesses.</p>",
        "<p>Have you built it, or tried? Then tell us, also if it failed:</p><ul>",
        "<li>a photograph of the gel from above, and one from the camera</li>",
        "<li>what <code>neurotouch gel check SOURCE --json</code> prints</li>",
        "<li>the file <code>gel.yaml</code>, the materials, and what you did differently</li>",
        "<li>what took longest, and what broke</li></ul>",
        "<p>Open an issue at the project, or a pull request that adds a row to the table of built "
        "gels in <code>docs/make-a-gel.md</code>.</p></section>",
        _figure(draw_cut(plan), _caption_cut(plan)),
        "<h2>1 What you need</h2>",
        _table(("amount", "what", "what matters"), needs),
    ]
    if parts:
        rows = [
            (f"{part.file}.stl", part.what, part.material, part.support or "none") for part in parts
        ]
        lines += ["<h2>2 Print</h2>", *_explain_printing(plan)]
        lines.append(_table(("file", "what", "material", "support"), rows))
        lines += [
            _figure(draw_part(part.file, part.solid), f"{part.file}: {part.what}.")
            for part in parts
        ]
    else:
        lines += [
            "<h2>2 Print the stencil</h2>",
            "<p>Print <code>stencil.pdf</code> at 100 %, and measure its ruler: 50 mm.</p>",
        ]
    lines += ["<h2>3 Make the skin</h2>", _list(_MAKE[plan.way](plan))]
    lines += ["<h2>4 Light</h2>", *_explain_light(plan)]
    lines += ["<h2>5 Put it together, and check</h2>", _list(_assemble(plan))]
    lines.append(_figure(draw_dots(plan), _caption_dots(plan)))
    lines += ["<h2>Other ways</h2>", "<ul>"]
    lines += [
        f"<li>{text} <code>neurotouch gel new --way {way}</code></li>"
        for way, text in _OTHERS.items()
        if way != plan.way
    ]
    lines += ["</ul></main></body></html>", ""]
    return "\n".join(lines)


def _explain_printing(plan: Plan) -> list[str]:
    text = (
        "<p>Each part lies as it is printed. Walls of 1.2 mm and more, no support where the table "
        "says none.</p>"
    )
    if plan.way != "printed":
        return [text]
    return [
        text,
        "<p><code>dome.3mf</code> has both colours in one file; the two <code>dome-</code> files "
        "are for programs that cannot read it: load them as one object with two parts.</p>",
    ]


def _make_evening(plan: Plan) -> list[str]:
    return [
        "Stretch the mat or balloon on the frame, flat and without folds, but not tight.",
        "Lay the stencil on the side that the camera will see. Tape it.",
        "Prick through the middle of each circle with a needle, then take the stencil off.",
        f"Put a dot of {plan.gel.dot_mm:g} mm on each mark with the pen. A dot may be off its "
        f"place by {0.15 * plan.gel.pitch_mm:.1f} mm. Let it dry.",
        "Is the pen wiped off by a finger? Then use paint for silicone, or white silicone glue.",
    ]


def _make_printed(plan: Plan) -> list[str]:
    return [
        *(
            [
                "Print the dome as it lies, the crown down, with support from the bed.",
                "Take the support off, and sand what a finger feels. The inner side stays as it "
                "is.",
            ]
            if plan.height
            else ["Print the skin as it lies; the dots are on top."]
        ),
        "Is the inner side shiny? Dull it: fine sandpaper, or a dull clear spray.",
    ]


def _make_cast(plan: Plan) -> list[str]:
    dots = "white" if plan.gel.light else "black"
    skin = "black" if plan.gel.light else "white"
    return [
        "Try 10 ml of silicone on a scrap of the mould first. It must cure, and come off. Some "
        "printed resins keep it from curing.",
        "Drop <code>pegs.stl</code> into <code>mould-top.stl</code> until its plate lies on it. "
        "Spread mould release on all that touches silicone.",
        f"Mix the silicone with {skin} pigment, and let its bubbles rise. Fill the lower half up "
        "to the edge.",
        "Lower the upper half at an angle, so that air escapes, then press it flat. The pins fit "
        "in one way only. Silicone comes out of vents and holes.",
        "Let it cure as long as its maker says. Take the pegs out first, then the skin.",
        f"Each dot is now a pit of 0.8 mm on the inner side. Fill the pits with {dots} silicone, "
        "and wipe it off flat with a card. Let it cure.",
        "Lay the clamp on the flange and punch the six holes for the screws.",
    ]


_MAKE: Final = {"evening": _make_evening, "printed": _make_printed, "cast": _make_cast}


def _explain_light(plan: Plan) -> list[str]:
    if plan.way == "evening":
        return [
            "<p>Lay a lamp on direct current into the box, beside the camera: a USB lamp or a "
            "torch behind white paper. A lamp on the mains flickers.</p>"
        ]
    return [
        "<p>Press the LEDs from below into the ring, long legs outwards. Solder a resistor to each "
        "long leg, and join these to +5 V and the short legs to 0 V. Test before you build it in. "
        "Do not dim it: dimmers make it flicker.</p>",
        _figure(draw_wiring(), "The circuit of the ring."),
        "<p>T is for a strobe, by which an event camera without frames sees a gel that nobody "
        "touches: see <code>docs/hardware.md</code>. Light that flashes 20 times a second can "
        "trigger seizures, so close the ring in. T is an N-channel MOSFET for gates of "
        "3.3 V, 20 V. Its pin is that of a microcontroller, whose 3.3 V hold the ring on.</p>",
    ]


def _assemble(plan: Plan) -> list[str]:
    check = (
        "Put <code>gel.yaml</code> into <code>~/.config/neurotouch/</code>, and run "
        "<code>neurotouch gel check SOURCE</code>, with the camera as SOURCE: <code>video:</code> "
        "or <code>davis:</code>. It says what to change. Turn the lens until the dots are sharp."
    )
    directions = (
        "From below, left and right are exchanged. Run <code>neurotouch doctor --source SOURCE "
        "--directions</code>: it asks for a push and a twist, and saves what it finds."
    )
    if plan.way == "evening":
        return [
            f"Stand the camera in the box, its lens {plan.distance:.0f} mm below the skin, in the "
            "middle. Close the box against light from outside.",
            check,
            directions,
        ]
    seat = (
        "Screw the board below the camera's plate, the lens through the hole."
        if plan.camera.seat == "board"
        else "Tie the camera below its plate, the lens in the middle of the hole."
    )
    return [
        "Drop the LED ring on its ledge, the LEDs up. Its wires go down along the wall, through "
        "the notch of the camera's plate.",
        seat,
        "Slide the plate up into the body. Put four screws with washers through the slots.",
        "Lay the skin on the body, the clamp on it, and turn the six screws in. They must hold the "
        "skin, not squeeze it.",
        f"{check} Move the plate by up to {TRAVEL_MM:g} mm if it says so, then tighten the screws.",
        directions,
    ]


def _caption_cut(plan: Plan) -> str:
    return (
        "Cut through the middle. In the light grey field the camera sees the gel. The gel fills "
        f"{100 * plan.measure_fill():.0f} % of the height of the picture."
    )


def _caption_dots(plan: Plan) -> str:
    text = f"What the camera sees: {plan.px_per_mm:.1f} of its pixels for a mm at the rim."
    if plan.find_reflections():
        text += (
            " Broken line: there a shiny skin mirrors the LEDs. Keep the skin dull. If spots stay, "
            "cover the LEDs with a ring of white paper."
        )
    return text


def _figure(sheet: Sheet, caption: str) -> str:
    return f"<figure>{sheet.write_svg()}<figcaption>{escape(caption)}</figcaption></figure>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f'<th scope="col">{each}</th>' for each in head)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{cells}</tr></thead><tbody>\n{body}\n</tbody></table>"


def _list(steps: Sequence[str]) -> str:
    return "<ol>" + "\n".join(f"<li>{step}</li>" for step in steps) + "</ol>"
