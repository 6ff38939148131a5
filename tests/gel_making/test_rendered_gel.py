"""The solids under another renderer's rays: our finder finds the gel, and it plays.

trimesh casts the rays; only the law of light is written here. Nothing of our simulator takes part.
"""

from io import BytesIO

import numpy as np
import pytest
import trimesh

from neurotouch_hid import open_gel
from neurotouch_hid.gel_making.mesh_files import write_stl
from neurotouch_hid.gel_making.parts import make_parts
from neurotouch_hid.gel_making.plan import N_LEDS
from neurotouch_hid.recording.clip import Picture
from neurotouch_hid.recording.clip_writer import ClipWriter
from neurotouch_hid.recording.simulation import Simulation
from neurotouch_hid.source.video.view_search import ViewSearch
from neurotouch_hid.source.view import ViewTable, whole_view
from neurotouch_hid.tracker import GelFinder
from tests.gel_making.plans import plan, write

DARK, LIGHT, GLOSS = 0.05, 0.85, 0.02
FRAME_US = 16_667
NOISE_DN = 1.5


class Scene:
    """The printed dome over its camera, with the LED ring lit."""

    def __init__(self, made, width_px, height_px):
        self.plan, self.size = made, (width_px, height_px)
        turn = trimesh.transformations.rotation_matrix(np.pi, (1, 0, 0))
        meshes = []
        for part in make_parts(made)[:2]:
            mesh = trimesh.load_mesh(BytesIO(write_stl(part.solid)), file_type="stl")
            mesh.apply_translation((0, 0, -made.height - made.skin))
            mesh.apply_transform(turn)  # from the pose in which it is printed
            meshes.append(mesh)
        self.mesh = trimesh.util.concatenate(meshes)
        self.is_light = np.arange(len(self.mesh.faces)) >= len(meshes[0].faces)
        focal = 0.5 * height_px / np.tan(np.radians(0.5 * made.camera.view_deg))
        y, x = np.mgrid[:height_px, :width_px].astype(float)
        self.rays = np.column_stack(
            [
                (x.ravel() - 0.5 * (width_px - 1)) / focal,
                -(y.ravel() - 0.5 * (height_px - 1)) / focal,  # the picture's top is away
                np.ones(width_px * height_px),
            ]
        )
        self.rays /= np.linalg.norm(self.rays, axis=1, keepdims=True)
        angle = 2 * np.pi * (np.arange(N_LEDS) + 0.5) / N_LEDS
        self.leds = np.column_stack(
            [
                made.radius * np.cos(angle),
                made.radius * np.sin(angle),
                np.full(N_LEDS, -made.led_depth),
            ]
        )

    def render(self, move=None):
        """A picture, (h, w) float, 255 is white; ``move`` maps corners of the mesh (n, 3)."""
        mesh = self.mesh
        if move is not None:
            mesh = trimesh.Trimesh(move(mesh.vertices), mesh.faces, process=False)
        lens = np.array([0.0, 0.0, -self.plan.distance])
        places, ray, face = mesh.ray.intersects_location(
            np.broadcast_to(lens, self.rays.shape), self.rays, multiple_hits=False
        )
        normal = mesh.face_normals[face]
        normal = np.where((normal * self.rays[ray]).sum(1, keepdims=True) > 0, -normal, normal)
        albedo = np.where(self.is_light[face], LIGHT, DARK)
        light = np.zeros(len(places))
        for led in self.leds:
            way = led - places
            far = np.linalg.norm(way, axis=1)
            way /= far[:, None]
            strength = np.maximum(-way[:, 2], 0.0) / far**2  # it looks up
            half = way - self.rays[ray]
            half /= np.linalg.norm(half, axis=1, keepdims=True)
            light += strength * albedo * np.maximum((normal * way).sum(1), 0.0)
            light += strength * GLOSS * np.maximum((normal * half).sum(1), 0.0) ** 20
        picture = np.zeros(len(self.rays))
        picture[ray] = light
        return picture.reshape(self.size[1], self.size[0])


@pytest.fixture(scope="module")
def scene():
    return Scene(plan("ps3eye", "large", "printed"), 640, 480)


@pytest.fixture(scope="module")
def rest(scene):
    return scene.render()


def expose(picture, white, seed):
    rng = np.random.default_rng(seed)
    noisy = 190.0 * picture / white + 6.0 + rng.normal(0.0, NOISE_DN, picture.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def test_the_finder_finds_every_dot_where_it_should_be(scene, rest):
    made = scene.plan
    pixels = expose(rest, np.percentile(rest, 99.0), 0)
    search = ViewSearch(GelFinder(made.gel), ViewTable(whole_view(640, 480)))
    for _ in range(2):  # the second picture confirms the first
        search.update(pixels)
    assert search.is_found
    canonical = np.empty((260, 346), np.uint8)
    search.table.draw(pixels, canonical)
    found = GelFinder(made.gel).find(canonical)
    assert found is not None
    places = search.table.view.to_sensor(found)
    z = made.find_height(np.hypot(*made.points.T))
    shown = made.project(np.column_stack([made.points, z])) * (480 / made.camera.height_px)
    wanted = shown * (1.0, -1.0) + (319.5, 239.5)
    # The lattice looks the same after a quarter of a turn.
    turns = [wanted]
    for _ in range(3):
        turns.append((turns[-1] - (319.5, 239.5)) @ [[0, 1], [-1, 0]] + (319.5, 239.5))
    off = [np.hypot(*(places - each).T) for each in turns]
    assert min(each.mean() for each in off) < 0.7  # px of 7 a mm
    # From the outermost dot at the top to that at the bottom, half a pitch and a dot are missing.
    across = np.ptp(places[:, 1]) / np.ptp(made.points[:, 1]) * 2 * made.radius
    assert 0.80 < across / 480 < 0.95


def test_a_finger_that_drags_the_skin_plays(scene, rest, tmp_path):
    made = scene.plan
    white = np.percentile(rest, 99.0)
    contact, reach = np.array([6.0, 4.0]), 9.0

    def drag(mm):
        def move(corners):
            far = np.hypot(*(corners[:, :2] - contact).T)
            edge = np.clip(1.0 - np.hypot(*corners[:, :2].T) / made.radius, 0.0, 1.0) ** 0.5
            share = np.exp(-0.5 * (far / reach) ** 2) * np.minimum(2.0 * edge, 1.0)
            return corners + np.column_stack([mm * share, 0 * share, 0 * share])

        return move

    steps = [scene.render(drag(mm)) for mm in np.linspace(0.0, 7.0, 6)[1:]]
    pictures = [rest] * 75 + steps + [steps[-1]] * 25 + steps[::-1] + [rest] * 10
    path = tmp_path / "drag.mkv"
    mark = Simulation("tests", "trimesh rays on the made solids")
    with ClipWriter(path, simulation=mark) as clip:
        for n, picture in enumerate(pictures):
            begin = n * FRAME_US
            clip.write(Picture(expose(picture, white, n), begin, begin + FRAME_US // 2))
    gel = tmp_path / "gel.yaml"
    gel.write_text(write("ps3eye", "large", "printed"))
    with open_gel(path, gel=gel, speed="max") as played:
        touches = list(played)
    held_us = [(75 + len(steps) + 5) * FRAME_US, (75 + len(steps) + 24) * FRAME_US]
    first_us = touches[0].t_us
    kinds = [
        touch for touch in touches if held_us[0] < touch.t_us - first_us < held_us[1] - 5 * FRAME_US
    ]
    assert len(kinds) > 5
    assert np.mean([touch.kind == "push" for touch in kinds]) > 0.9
    x, y = np.median([touch.translation_mm for touch in kinds], axis=0)
    assert x > 3.0
    assert abs(y) < 0.25 * x
    quiet = [touch.kind for touch in touches if touch.t_us - first_us < 70 * FRAME_US]
    assert set(quiet) <= {"none"}
