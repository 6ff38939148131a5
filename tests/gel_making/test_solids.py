"""The solids, as another library reads their files: closed, thick enough, printable, in place."""

from io import BytesIO

import numpy as np
import pytest
import trimesh

from neurotouch_hid.driver.making_settings import PIT_MM, THINNEST_MM
from neurotouch_hid.gel_making.mesh_files import write_3mf, write_stl
from neurotouch_hid.gel_making.parts import make_parts
from neurotouch_hid.gel_making.skin import make_mould, make_skin
from tests.gel_making.plans import plan, read, write

PLANS = [
    ("webcam", "large", "cast"),
    ("board", "small", "cast"),
    ("davis346", "large", "printed"),
    ("ps3eye", "small", "printed"),
]
STEEP = np.sin(np.radians(45.0)) + 1e-3
HELD_MM = 0.05


def load(part):
    return trimesh.load_mesh(BytesIO(write_stl(part.solid)), file_type="stl")


@pytest.fixture(scope="module", params=PLANS, ids="-".join)
def made(request):
    return plan(*request.param)


@pytest.fixture(scope="module")
def parts(made):
    return {part.file: (part, load(part)) for part in make_parts(made)}


def test_every_solid_is_closed_and_stands_on_the_bed(parts):
    for part, mesh in parts.values():
        assert mesh.is_watertight, part.file
        assert mesh.is_winding_consistent, part.file
        assert mesh.is_volume, part.file
        assert mesh.volume > 0.0, part.file
        if part.file not in ("dome-dark", "dome-light"):
            assert mesh.bounds[0, 2] == pytest.approx(0.0, abs=1e-4), part.file
        assert (mesh.extents < 250.0).all(), part.file
        n_bodies = len(mesh.split(only_watertight=False))
        assert n_bodies == (177 if part.file == "dome-light" else 1), part.file


def test_only_what_says_so_needs_support(parts):
    for part, mesh in parts.values():
        hangs = (mesh.face_normals[:, 2] < -STEEP) & (mesh.triangles_center[:, 2] > HELD_MM)
        area = mesh.area_faces[hangs].sum()
        assert (area > 1.0) == bool(part.support), (part.file, area)


def measure_walls(mesh, n):
    """The distance between opposite faces at random places, mm, and the places."""
    rng = np.random.default_rng(1)
    places, faces = trimesh.sample.sample_surface(mesh, n, seed=rng)
    normal = mesh.face_normals[faces]
    start = places - 1e-4 * normal
    hits, ray, hit = mesh.ray.intersects_location(start, -normal, multiple_hits=False)
    opposite = (mesh.face_normals[hit] * normal[ray]).sum(axis=1) < -0.9
    return np.linalg.norm(hits - start[ray], axis=1)[opposite], places[ray][opposite]


def test_no_wall_is_thinner_than_three_lines_of_a_nozzle(made, parts):
    for part, mesh in parts.values():
        if part.file == "dome-light":
            continue  # a dot is as wide and deep as it should be
        walls, places = measure_walls(mesh, 6000)
        assert len(walls) > 1000, part.file
        if part.file == "pegs":
            apart = np.hypot(*(places[:, None, :2] - made.points).transpose(2, 0, 1)).min(axis=1)
            walls = walls[apart > 0.5 * made.gel.dot_mm + 0.05]
        assert walls.min() > THINNEST_MM - 0.01, part.file


def test_a_thin_wall_would_be_seen():
    thin = trimesh.creation.annulus(10.0, 11.0, 5.0)
    walls, _ = measure_walls(thin, 2000)
    assert walls.min() < 1.05


def find_places(mesh, n, dot_mm):
    """The middle of each upright dot of a mesh, (n, 2) mm."""
    bodies = mesh.split()
    assert len(bodies) == n
    boxes = np.array([body.bounds[:, :2] for body in bodies])
    np.testing.assert_allclose(boxes[:, 1] - boxes[:, 0], dot_mm, atol=0.02)
    return boxes.mean(axis=1)


def match(places, points):
    away = np.hypot(*(places[:, None] - points).transpose(2, 0, 1))
    assert len(set(away.argmin(axis=1).tolist())) == len(points)
    return away.min(axis=1).max()


SQUARE = "square, pitch_mm: 4, radius_mm: 30"
LAYOUT = "points, points_mm: [{}]".format(
    ", ".join(
        f"[{4 * (k % 9) - 16 + 0.3 * (k % 3)}, {4 * (k // 9) - 10 + 0.2 * (k % 4)}]"
        for k in range(54)
    )
)
"""Dots without any symmetry, so a mirrored or turned part would be seen."""
layouts = pytest.mark.parametrize("layout", [SQUARE, LAYOUT], ids=["square", "points"])


def lay(way, layout):
    """A lower dome with a layout."""
    text = write(way=way).replace(SQUARE, layout)
    return read(text.replace("dome_height_mm: 15", "dome_height_mm: 8"))


@layouts
def test_dots_of_the_dome_are_at_their_places(layout):
    made = lay("printed", layout)
    dots = next(part for part in make_parts(made) if part.file == "dome-light")
    places = find_places(load(dots), made.gel.n_markers, made.gel.dot_mm)
    # It is printed upside down, turned about x; then y of the file is y towards the user again.
    assert match(places, made.gel.points_mm) < 0.01


@layouts
def test_pegs_are_at_the_places_of_the_dots(layout):
    made = lay("cast", layout)
    _, _, plug = make_mould(made)
    smooth = 9.0  # the plug's dome begins as high above its bed
    mesh = trimesh.load_mesh(BytesIO(write_stl(plug)), file_type="stl")
    centres = []
    for x, y in made.points:
        r = float(np.hypot(x, y))
        height = smooth + float(made.find_height(np.array([r]))[0]) + 0.5 * PIT_MM
        ring = mesh.section(plane_origin=(0, 0, height), plane_normal=(0, 0, 1))
        loops = [loop[:, :2] for loop in ring.discrete]
        near = [loop for loop in loops if np.hypot(*(loop.mean(axis=0) - (x, y))) < 1.0]
        if near and r < 8.0:  # further out the section cuts the dome too
            box = near[0]
            centres.append(np.hypot(*(0.5 * (box.min(axis=0) + box.max(axis=0)) - (x, y))))
    assert len(centres) >= 4
    assert max(centres) < 0.01
    pits = make_skin(made, holes=False) - plug.translate((0.0, 0.0, -smooth))
    lost = float(make_skin(made, holes=False).volume() - pits.volume())
    one = np.pi / 4.0 * made.gel.dot_mm**2 * PIT_MM
    assert lost / (made.gel.n_markers * one) == pytest.approx(1.15, abs=0.2)


def test_the_mould_holds_just_the_skin(made):
    low, frame, plug = make_mould(made)
    top = low.bounding_box()[5]
    low = low.rotate((180.0, 0.0, 0.0)).translate((0.0, 0.0, top))
    plug, frame = plug.translate((0.0, 0.0, -9.0)), frame.translate((0.0, 0.0, -6.0))
    skin = make_skin(made, holes=False)
    for one, other in ((low, frame), (low, plug), (frame, plug), (low, skin), (frame, skin)):
        assert (one ^ other).volume() < 2.0  # mm³: polygons of one circle do not touch exactly
    pegs = (plug ^ skin).volume()
    assert 0.5 < pegs / (made.gel.n_markers * np.pi / 4 * made.gel.dot_mm**2 * PIT_MM) < 1.6


def test_both_colours_are_in_one_3mf(made):
    if made.way != "printed":
        pytest.skip("a cast gel has one colour at a time")
    dome = [part for part in make_parts(made) if part.file.startswith("dome")]
    data = write_3mf({part.file: (part.solid, "#202020") for part in dome})
    scene = trimesh.load_scene(BytesIO(data), file_type="3mf")
    assert scene.units == "millimeter"
    assert set(scene.geometry) == {"dome-dark", "dome-light"}
    for part in dome:
        mesh = scene.geometry[part.file]
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(part.solid.volume(), rel=1e-4)


def find_slivers(section):
    """The area of the largest piece that is thinner than a wall may be, mm².

    What a disc as wide as the thinnest wall cannot reach is taken out; of a sharp corner that is
    little, of a thin wall all.
    """
    import manifold3d

    reach = 0.5 * THINNEST_MM - 0.02
    corner = manifold3d.JoinType.Round
    opened = section.offset(-reach, corner).offset(reach + 0.03, corner)
    return max((piece.area() for piece in (section - opened).decompose()), default=0.0)


MOST_MM2 = 0.7


def test_no_cut_through_a_part_shows_a_thin_wall(parts):
    for part, mesh in parts.values():
        if part.file in ("dome-light", "pegs"):
            continue  # dots are thinner
        # A level cut through a shallow dome has sharp corners, but no thin wall.
        for share in np.linspace(0.02, 0.98, 25 if part.file != "dome-dark" else 0):
            area = find_slivers(part.solid.slice(float(share * mesh.bounds[1, 2])))
            assert area < MOST_MM2, (part.file, share)
        for angle in (0, 45, 60, 90, 120, 135):  # through doors, slots, screws and feet
            turned = part.solid.rotate((0.0, 0.0, float(angle))).rotate((90.0, 0.0, 0.0))
            assert find_slivers(turned.slice(0.0)) < MOST_MM2, (part.file, angle)
