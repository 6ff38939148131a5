"""A drawing in millimetres of circles, paths and words, and its two files: SVG and PDF.

A page of circles and lines needs no library for PDF: one page, one stream, a font of every reader.
"""

from dataclasses import dataclass, field
from html import escape
from typing import Final, Literal

GREY: Final = 0.75
_PT: Final = 72.0 / 25.4
_BEZIER: Final = 0.5522847498  # a quarter of a circle
_NARROW: Final = frozenset(" .,:;'!|()fijlt")

Anchor = Literal["start", "middle", "end"]


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle; ``fill`` is a grey level, 0 black to 1 white, or None."""

    x: float
    y: float
    radius: float
    line: float = 0.25
    fill: float | None = None
    dash: bool = False


@dataclass(frozen=True, slots=True)
class Path:
    """Straight lines through points; filled as ``Circle`` if they are closed."""

    points: tuple[tuple[float, float], ...]
    line: float = 0.25
    closed: bool = False
    fill: float | None = None
    dash: bool = False


@dataclass(frozen=True, slots=True)
class Words:
    """A line of text; y is its foot."""

    x: float
    y: float
    text: str
    size: float = 4.0
    anchor: Anchor = "start"


@dataclass(slots=True)
class Sheet:
    """A drawing; y goes down.

    Attributes:
        width, height: in mm.
        title: what it shows, for people who do not see it.
        shapes: drawn in this order.
    """

    width: float
    height: float
    title: str
    shapes: list[Circle | Path | Words] = field(default_factory=list)

    def add(self, *shapes: Circle | Path | Words) -> None:
        """Draws more shapes."""
        self.shapes += shapes

    def line(self, *points: tuple[float, float], width: float = 0.25, dash: bool = False) -> None:
        """Draws a line through points."""
        self.add(Path(points, width, dash=dash))

    def write_svg(self) -> str:
        """Returns the drawing as SVG that prints in its true size."""
        size = f"{self.width:g}", f"{self.height:g}"
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]}mm" height="{size[1]}mm" '
            f'viewBox="0 0 {size[0]} {size[1]}" role="img" font-family="Helvetica, Arial, '
            'sans-serif">',
            f"<title>{escape(self.title)}</title>",
            *map(_draw_svg, self.shapes),
            "</svg>\n",
        ]
        return "\n".join(lines)

    def write_pdf(self) -> bytes:
        """Returns the drawing as a PDF page that printers do not scale by themselves."""
        lines = [f"{_PT:.6f} 0 0 {-_PT:.6f} 0 {self.height * _PT:.4f} cm 1 J 1 j"]
        lines += map(_draw_pdf, self.shapes)
        stream = "\n".join(lines).encode("cp1252", "replace")
        box = f"[0 0 {self.width * _PT:.3f} {self.height * _PT:.3f}]"
        return _join_objects(
            [
                b"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
                b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents 4 0 R "
                "/Resources << /Font << /F 5 0 R >> >> >>".encode(),
                f"<< /Length {len(stream)} >>\nstream\n".encode() + stream + b"\nendstream",
                b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica "
                b"/Encoding /WinAnsiEncoding >>",
            ]
        )


def _draw_svg(shape: Circle | Path | Words) -> str:
    if isinstance(shape, Words):
        return (
            f'<text x="{shape.x:.3f}" y="{shape.y:.3f}" font-size="{shape.size:g}" '
            f'text-anchor="{shape.anchor}">{escape(shape.text)}</text>'
        )
    grey = None if shape.fill is None else f"#{3 * f'{round(255 * shape.fill):02x}'}"
    dash = ' stroke-dasharray="2 1.5"' if shape.dash else ""
    stroke = f'stroke="{"#000" if shape.line else "none"}" stroke-width="{shape.line:g}"{dash}'
    style = f'fill="{grey or "none"}" {stroke}'
    if isinstance(shape, Circle):
        return f'<circle cx="{shape.x:.4f}" cy="{shape.y:.4f}" r="{shape.radius:.4f}" {style}/>'
    points = " ".join(f"{x:.3f},{y:.3f}" for x, y in shape.points)
    return f'<{"polygon" if shape.closed else "polyline"} points="{points}" {style}/>'


def _draw_pdf(shape: Circle | Path | Words) -> str:
    if isinstance(shape, Words):
        shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[shape.anchor]
        x = shape.x - shift * shape.size * _measure(shape.text)
        text = shape.text.replace("\\", "\\\\").replace("(", "\\(").replace(")", "\\)")
        return f"BT 0 g /F {shape.size:g} Tf 1 0 0 -1 {x:.3f} {shape.y:.3f} Tm ({text}) Tj ET"
    paint = "B" if shape.fill is not None and shape.line else "f" if shape.fill is not None else "S"
    head = f"0 G {shape.line:g} w {'[2 1.5]' if shape.dash else '[]'} 0 d"
    if shape.fill is not None:
        head += f" {shape.fill:g} g"
    if isinstance(shape, Circle):
        return f"{head} {_trace_circle(shape)} {paint}"
    first, *others = [f"{x:.3f} {y:.3f}" for x, y in shape.points]
    path = " ".join([f"{first} m", *(f"{point} l" for point in others)])
    return f"{head} {path} {'h ' if shape.closed else ''}{paint}"


def _measure(text: str) -> float:
    """Returns about how wide a text is in Helvetica, in sizes; SVG needs no such guess."""
    return sum(0.26 if letter in _NARROW else 0.55 for letter in text)


def _trace_circle(circle: Circle) -> str:
    x, y, r = circle.x, circle.y, circle.radius
    k = _BEZIER * r
    turns = [
        (x + r, y + k, x + k, y + r, x, y + r),
        (x - k, y + r, x - r, y + k, x - r, y),
        (x - r, y - k, x - k, y - r, x, y - r),
        (x + k, y - r, x + r, y - k, x + r, y),
    ]
    curves = " ".join(" ".join(f"{value:.4f}" for value in turn) + " c" for turn in turns)
    return f"{x + r:.4f} {y:.4f} m {curves} h"


def _join_objects(objects: list[bytes]) -> bytes:
    """Returns a PDF file of objects, numbered from 1; the first is the catalogue."""
    out = bytearray(b"%PDF-1.6\n%\xe2\xe3\xcf\xd3\n")
    places = []
    for number, content in enumerate(objects, 1):
        places.append(len(out))
        out += b"%d 0 obj\n%b\nendobj\n" % (number, content)
    begin = len(out)
    out += b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1)
    out += b"".join(b"%010d 00000 n \n" % place for place in places)
    out += b"trailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (
        len(objects) + 1,
        begin,
    )
    return bytes(out)
