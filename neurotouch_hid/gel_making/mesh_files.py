"""Writes solids as STL and 3MF. The same solids give the same bytes."""

import zipfile
from collections.abc import Mapping
from io import BytesIO
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import Floats

if TYPE_CHECKING:
    from manifold3d import Manifold

_TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
_YEAR: Final = (1980, 1, 1, 0, 0, 0)  # the first that a zip file knows
_CORE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PACKAGE: Final = "http://schemas.openxmlformats.org/package/2006"
_MODEL: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_TYPES: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<Types xmlns="{_PACKAGE}/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS: Final = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<Relationships xmlns="{_PACKAGE}/relationships">'
    f'<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="{_MODEL}"/></Relationships>'
)


def write_stl(solid: "Manifold") -> bytes:
    """Returns a binary STL file, in mm."""
    points, triangles = _find_mesh(solid)
    corners = points.astype(np.float32)[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    table = np.zeros(len(triangles), _TRIANGLE)
    table["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    table["corners"] = corners
    head = b"neurotouch gel, mm".ljust(80)
    return head + np.uint32(len(table)).tobytes() + table.tobytes()


def write_3mf(solids: "Mapping[str, tuple[Manifold, str]]") -> bytes:
    """Returns a 3MF file with several solids that keep their places.

    Args:
        solids: each with its colour, ``#RRGGBB``.
    """
    bases = "".join(
        f'<base name="{name}" displaycolor="{colour}"/>' for name, (_, colour) in solids.items()
    )
    objects, components = [], []
    for number, (name, (solid, _)) in enumerate(solids.items()):
        points, triangles = _find_mesh(solid)
        corners = "".join(f'<vertex x="{x:.5f}" y="{y:.5f}" z="{z:.5f}"/>' for x, y, z in points)
        faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles)
        objects.append(
            f'<object id="{number + 2}" type="model" name="{name}" pid="1" pindex="{number}"><mesh>'
            f"<vertices>{corners}</vertices><triangles>{faces}</triangles></mesh></object>\n"
        )
        components.append(f'<component objectid="{number + 2}"/>')
    whole = len(solids) + 2
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="millimeter" xml:lang="en" xmlns="{_CORE}"><resources>'
        f'<basematerials id="1">{bases}</basematerials>\n{"".join(objects)}'
        f'<object id="{whole}" type="model"><components>{"".join(components)}</components></object>'
        f'</resources><build><item objectid="{whole}"/></build></model>'
    )
    files = {
        "[Content_Types].xml": _TYPES,
        "_rels/.rels": _RELATIONS,
        "3D/3dmodel.model": model,
    }
    out = BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            info = zipfile.ZipInfo(name, _YEAR)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, text)
    return out.getvalue()


def _find_mesh(solid: "Manifold") -> tuple[Floats, NDArray[np.intp]]:
    """Returns corners (n, 3) and triangles (m, 3)."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, np.intp)
