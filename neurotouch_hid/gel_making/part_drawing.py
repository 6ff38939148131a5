"""Draws a solid as seen from above, and cut through the middle."""

from typing import TYPE_CHECKING, Final

from neurotouch_hid.gel_making.sheet import Path, Sheet, Words

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_WIDE_MM: Final = 60.0
_TALL_MM: Final = 62.0


def draw_part(name: str, solid: "Manifold") -> Sheet:
    """Returns a drawing of a part, from above at the left and cut at the right."""
    x0, y0, z0, x1, y1, z1 = solid.bounding_box()
    scale = min(_WIDE_MM / (x1 - x0), _TALL_MM / max(y1 - y0, z1 - z0), 1.0)
    tall = scale * max(y1 - y0, z1 - z0)
    sheet = Sheet(2.0 * _WIDE_MM + 14.0, tall + 14.0, f"{name}: from above, and cut")
    middle = 4.0 + 0.5 * tall
    above = solid.project()
    cut = solid.rotate((-90.0, 0.0, 0.0)).slice(0.0)  # (x, z) becomes (x, -y)
    left, sums = (4.0 + 0.5 * _WIDE_MM, middle), (x0 + x1, y0 + y1)
    _draw(sheet, above, scale, left, sums, 0.95)
    _draw(sheet, solid.slice(z1 - 0.05), scale, left, sums, 0.8)  # its highest faces
    at = (10.0 + 1.5 * _WIDE_MM, middle)
    low, high = cut.bounds()[1], cut.bounds()[3]
    _draw(sheet, cut, scale, at, (x0 + x1, low + high), 0.55)
    size = f"{x1 - x0:.0f} x {y1 - y0:.0f} x {z1 - z0:.0f} mm"
    sheet.add(Words(4.0 + 0.5 * _WIDE_MM, tall + 12.0, "from above", 3.6, "middle"))
    sheet.add(Words(at[0], tall + 12.0, f"cut; {size}", 3.6, "middle"))
    return sheet


def _draw(
    sheet: Sheet,
    section: "CrossSection",
    scale: float,
    at: tuple[float, float],
    sums: tuple[float, float],
    grey: float,
) -> None:
    """Draws a section around a place; its outlines first, then its holes."""
    polygons = section.simplify(0.05).to_polygons()

    def area(points: "list[list[float]]") -> float:
        return sum(
            a[0] * b[1] - b[0] * a[1] for a, b in zip(points, [*points[1:], points[0]], strict=True)
        )

    shapes = [[[float(x), float(y)] for x, y in points] for points in polygons]
    for points in sorted(shapes, key=lambda each: -area(each)):
        placed = tuple(
            (at[0] + scale * (x - 0.5 * sums[0]), at[1] - scale * (y - 0.5 * sums[1]))
            for x, y in points
        )
        sheet.add(Path(placed, 0.2, closed=True, fill=grey if area(points) > 0.0 else 1.0))
