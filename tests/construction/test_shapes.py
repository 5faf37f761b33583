"""Geometry and mass properties of every shape: volumes and inertias against formulas, meshes closed, pieces tiling."""

import math
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from worldagent.construction import build_entity
from worldagent.construction.polygons import convex_partition, signed_area, triangulate
from worldagent.construction.primitives import build_shape
from worldagent.tests.physics.rigid_world import NO_ASSETS, box, entity, world
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec import Box, Capsule, Cylinder, Extrusion, HeightField, Mesh, Revolution, Sphere, Wedge

DENSITY = 1000.0
EXACT = 1e-9
"""Relative error of integrals over polyhedra and of closed forms."""
TILING = 1e-9
"""Relative difference between the volume of a mesh and the sum of its convex pieces."""

STAR = [(math.cos(math.pi * k / 5) * (1 if k % 2 else 0.4), math.sin(math.pi * k / 5) * (1 if k % 2 else 0.4)) for k in range(10)]
COMB = [
    (0, 0),
    (7, 0),
    (7, 3),
    (6, 3),
    (6, 1),
    (5, 1),
    (5, 3),
    (4, 3),
    (4, 1),
    (3, 1),
    (3, 3),
    (2, 3),
    (2, 1),
    (1, 1),
    (1, 3),
    (0, 3),
]
BOWL = [(0.0, 0.0), (0.15, 0.0), (0.3, 0.15), (0.28, 0.15), (0.14, 0.02), (0.0, 0.02)]
RING = [(0.2, 0.0), (0.3, 0.0), (0.3, 0.1), (0.2, 0.1)]
CONE = [(0.0, 0.0), (0.2, 0.0), (0.0, 0.5)]
HILLS = (0.2 * np.sin(np.arange(7))[:, None] * np.cos(np.arange(9))[None, :]).tolist()

SHAPES: dict[str, Any] = {
    "box": Box(size=(0.1, 0.2, 0.3)),
    "sphere": Sphere(radius=0.2),
    "cylinder": Cylinder(radius=0.1, height=0.4),
    "capsule": Capsule(radius=0.1, length=0.3),
    "wedge": Wedge(size=(0.4, 0.2, 0.1)),
    "star": Extrusion(polygon=STAR, height=0.3),
    "comb": Extrusion(polygon=COMB, height=0.5),
    "bowl": Revolution(profile=BOWL, segments=24),
    "ring": Revolution(profile=RING, segments=17),
    "cone": Revolution(profile=CONE, segments=12),
    "hills": HeightField(size=(2, 3), heights=HILLS),
}
TILED = ("box", "wedge", "star", "comb", "bowl", "ring", "cone")


def _trimesh(geometry):
    return trimesh.Trimesh(geometry.render.vertices, geometry.render.faces, process=False)


@pytest.mark.parametrize("name", SHAPES)
def test_visible_meshes_are_closed_and_face_outwards(name):
    mesh = _trimesh(build_shape(SHAPES[name], NO_ASSETS))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0


def _body(shape):
    spec = world({"e": entity(shape.model_dump(exclude_none=True))})
    return build_entity(spec, "e", NO_ASSETS).bodies[0]


def _prism(polygon, height):
    """Volume, centre and inertia about it, of unit density, from Green's theorem on the polygon."""
    x, y = np.array(polygon).T
    nx, ny = np.roll(x, -1), np.roll(y, -1)
    c = x * ny - nx * y
    area = c.sum() / 2
    cx, cy = ((x + nx) * c).sum() / 6 / area, ((y + ny) * c).sum() / 6 / area
    xx = ((x * x + x * nx + nx * nx) * c).sum() / 12 - area * cx * cx
    yy = ((y * y + y * ny + ny * ny) * c).sum() / 12 - area * cy * cy
    xy = ((x * ny + 2 * x * y + 2 * nx * ny + nx * y) * c).sum() / 24 - area * cx * cy
    zz = area * height**2 / 12
    inertia = height * np.array([[yy + zz, -xy, 0], [-xy, xx + zz, 0], [0, 0, xx + yy]])
    return area * height, (cx, cy, 0), inertia


def test_mass_properties_of_primitives_are_the_textbook_ones():
    x, y, z = 0.1, 0.2, 0.3
    b = _body(SHAPES["box"])
    assert b.mass == pytest.approx(DENSITY * x * y * z, rel=EXACT)
    assert b.inertia == pytest.approx(b.mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y]), rel=EXACT, abs=1e-12)
    s = _body(SHAPES["sphere"])
    assert s.volume == pytest.approx(4 / 3 * math.pi * 0.2**3, rel=EXACT)
    assert s.inertia == pytest.approx(0.4 * s.mass * 0.2**2 * np.eye(3), rel=EXACT, abs=1e-12)
    c = _body(SHAPES["cylinder"])
    side = c.mass / 12 * (3 * 0.1**2 + 0.4**2)
    assert c.volume == pytest.approx(math.pi * 0.1**2 * 0.4, rel=EXACT)
    assert c.inertia == pytest.approx(np.diag([side, side, c.mass * 0.1**2 / 2]), rel=EXACT, abs=1e-12)


def test_mass_properties_of_a_capsule_agree_with_its_integral():
    k = _body(SHAPES["capsule"])
    r, half = 0.1, 0.15
    z = np.linspace(-half - r, half + r, 200001)
    radius2 = np.where(np.abs(z) < half, r * r, np.maximum(r * r - (np.abs(z) - half) ** 2, 0))
    volume = np.trapezoid(math.pi * radius2, z)
    axial = np.trapezoid(math.pi * radius2**2 / 2, z)
    side = np.trapezoid(math.pi * radius2**2 / 4 + math.pi * radius2 * z * z, z)
    assert k.volume == pytest.approx(volume, rel=1e-6)
    assert k.inertia == pytest.approx(DENSITY * np.diag([side, side, axial]), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["wedge", "star", "comb"])
def test_mass_properties_of_prisms_agree_with_greens_theorem(name):
    shape = SHAPES[name]
    if name == "wedge":
        x, y, z = (s / 2 for s in shape.size)
        # In the (x, z) plane the wedge is a triangle; its extrusion axis is y.
        volume, (cx, cz, _), inertia = _prism([(-x, -z), (x, -z), (-x, z)], 2 * y)
        center, swap = (cx, 0, cz), [0, 2, 1]
        inertia = inertia[np.ix_(swap, swap)]
    else:
        volume, center, inertia = _prism(shape.polygon, shape.height)
    body = _body(shape)
    assert body.volume == pytest.approx(volume, rel=EXACT)
    assert body.center == pytest.approx(center, abs=1e-9)
    assert body.inertia == pytest.approx(DENSITY * inertia, rel=EXACT, abs=1e-6 * DENSITY * np.trace(inertia))


def test_a_revolved_ring_has_the_volume_of_its_polygonal_ring():
    n = 17
    area = 0.5 * n * math.sin(2 * math.pi / n)
    assert _body(SHAPES["ring"]).volume == pytest.approx(area * (0.3**2 - 0.2**2) * 0.1, rel=EXACT)


@pytest.mark.parametrize("name", TILED)
def test_convex_pieces_tile_the_visible_mesh(name):
    geometry = build_shape(SHAPES[name], NO_ASSETS)
    volume = 0.0
    for piece in geometry.collision:
        if piece.kind == "box":
            volume += 8 * math.prod(piece.params)
        else:
            hull = ConvexHull(piece.points)
            depth = -(piece.points @ hull.equations[:, :3].T + hull.equations[:, 3]).max(1)
            assert depth.max() < 1e-9, "every point of a piece lies on its hull"
            volume += hull.volume
    mesh = _trimesh(geometry)
    assert volume == pytest.approx(mesh.volume, rel=TILING)
    built = build_entity(world({"e": entity(SHAPES[name].model_dump(exclude_none=True))}), "e", NO_ASSETS)
    assert built.parts[0].deviation == (0.0, 0.0)


@pytest.mark.parametrize("name", ["sphere", "cylinder", "capsule"])
def test_visible_facets_lie_inside_the_analytic_shape_by_no_more_than_declared(name):
    geometry = build_shape(SHAPES[name], NO_ASSETS)
    corners = geometry.render.vertices[geometry.render.faces]
    points = np.concatenate([geometry.render.vertices, corners.mean(1), 0.5 * (corners[:, 0] + corners[:, 1])])
    shape = SHAPES[name]
    if name == "sphere":
        outside = np.linalg.norm(points, axis=1) - shape.radius
    elif name == "cylinder":
        outside = np.maximum(np.hypot(points[:, 0], points[:, 1]) - shape.radius, np.abs(points[:, 2]) - shape.height / 2)
    else:
        z = np.sign(points[:, 2]) * np.maximum(np.abs(points[:, 2]) - 0, 0)
        z = np.clip(z, -shape.length / 2, shape.length / 2)
        outside = np.linalg.norm(points - np.stack([0 * z, 0 * z, z], axis=1), axis=1) - shape.radius
    assert outside.max() < 1e-12
    surface = outside[np.abs(points[:, 2]) < 0.9 * shape.height / 2] if name == "cylinder" else outside
    assert -surface.min() <= geometry.facet_error * (1 + 1e-9)


def test_parts_add_up_by_the_parallel_axis_theorem():
    dumbbell = box(0.2, 0.2, 0.2)
    dumbbell["parts"] = {
        n: {"shape": {"kind": "box", "size": (0.2, 0.2, 0.2)}, "pose": {"position": (x, 0, 0)}}
        for n, x in (("l", -0.5), ("r", 0.5))
    }
    body = build_entity(world({"e": dumbbell}), "e", NO_ASSETS).bodies[0]
    own = 8.0 * (0.04 + 0.04) / 12
    assert body.mass == pytest.approx(16.0)
    assert np.diag(body.inertia) == pytest.approx([2 * own, 2 * own + 16 * 0.25, 2 * own + 16 * 0.25])
    dumbbell["physics"]["mass"] = 4.0
    scaled = build_entity(world({"e": dumbbell}), "e", NO_ASSETS).bodies[0]
    assert scaled.mass == pytest.approx(4.0)
    assert scaled.inertia == pytest.approx(body.inertia / 4)


def test_a_turned_part_turns_its_inertia():
    turned = box(0.1, 0.2, 0.3)
    turned["parts"]["p"]["pose"] = {"euler": (0, 0, math.pi / 2)}
    body = build_entity(world({"e": turned}), "e", NO_ASSETS).bodies[0]
    plain = build_entity(world({"e": box(0.2, 0.1, 0.3)}), "e", NO_ASSETS).bodies[0]
    assert body.inertia == pytest.approx(plain.inertia, abs=1e-12)


@pytest.mark.parametrize("clockwise", [False, True])
def test_profiles_may_run_either_way(clockwise):
    profile = BOWL[::-1] if clockwise else BOWL
    assert _trimesh(build_shape(Revolution(profile=profile), NO_ASSETS)).volume > 0


@pytest.mark.parametrize("seed", range(12))
def test_random_simple_polygons_are_partitioned_into_convex_pieces(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 30))
    angle = np.sort(rng.uniform(0, 2 * math.pi, count))
    if np.diff(angle, append=angle[0] + 2 * math.pi).max() > 3.0:
        angle = np.linspace(0, 2 * math.pi, count, endpoint=False)
    radius = rng.uniform(0.2, 1.0, count)
    polygon = [(float(r * math.cos(a)), float(r * math.sin(a))) for r, a in zip(radius, angle, strict=True)]
    rings = convex_partition(polygon)
    assert sum(signed_area([polygon[i] for i in ring]) for ring in rings) == pytest.approx(signed_area(polygon), rel=1e-9)
    assert len(triangulate(polygon)) == count - 2


@pytest.mark.parametrize(
    ("polygon", "words"),
    [
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "cross"),
        ([(0, 0), (1, 0), (2, 0)], "touches"),
        ([(0, 0), (1, 0), (1, 1), (0.5, 0), (0, 1)], "touches"),
    ],
)
def test_bad_polygons_are_refused(polygon, words):
    with pytest.raises(InputError, match=words):
        build_shape(Extrusion(polygon=polygon, height=1.0), NO_ASSETS)


def test_a_clockwise_polygon_is_turned():
    square = [(0, 0), (0, 1), (1, 1), (1, 0)]
    assert _trimesh(build_shape(Extrusion(polygon=square, height=1.0), NO_ASSETS)).volume == pytest.approx(1.0)


def test_an_open_mesh_is_refused_with_a_way_out():
    cube = trimesh.creation.box((1, 1, 1))
    shape = Mesh(vertices=cube.vertices.tolist(), faces=cube.faces[:-1].tolist())
    with pytest.raises(InputError, match="close its holes"):
        build_shape(shape, NO_ASSETS)


def test_a_mesh_with_wrong_indices_or_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="out of range"):
        build_shape(Mesh(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces=[(0, 1, 3)]), NO_ASSETS)
    with pytest.raises(InputError, match="in the world's assets"):
        build_shape(Mesh(file="nothing.obj"), tmp_path)


def test_an_inside_out_mesh_is_turned():
    cube = trimesh.creation.box((1, 1, 1))
    geometry = build_shape(Mesh(vertices=cube.vertices.tolist(), faces=cube.faces[:, ::-1].tolist(), scale=0.5), NO_ASSETS)
    assert _trimesh(geometry).volume == pytest.approx(0.125)
    assert len(geometry.collision) == 1


def test_a_decomposed_mesh_declares_how_far_its_pieces_are_from_it():
    torus = trimesh.creation.torus(0.3, 0.1, major_sections=24, minor_sections=12)
    shape = {"kind": "mesh", "vertices": torus.vertices.tolist(), "faces": torus.faces.tolist()}
    part = build_entity(world({"e": entity(shape)}), "e", NO_ASSETS).parts[0]
    assert len(part.collision) > 3
    # The visible surface hardly reaches outside the pieces; they fill its hollows a little.
    assert part.deviation[1] < 5e-4
    assert 1e-4 < part.deviation[0] < 0.05
    hull = build_entity(world({"e": entity(shape | {"collision": "hull"})}), "e", NO_ASSETS).parts[0]
    assert hull.deviation[0] > 0.05
    assert hull.deviation[1] < 1e-9


def test_unknown_materials_are_refused():
    with pytest.raises(InputError, match="not declared"):
        build_entity(world({"e": box(1, 1, 1, material="unobtainium")}), "e", NO_ASSETS)


def test_rope_segments_lie_end_to_end_and_share_the_declared_mass():
    rope = entity(
        generator={"kind": "rope", "points": [(0, 0, 0), (1, 0, 0), (1, 1, 0)], "radius": 0.01, "segments": 20}, mass=0.5
    )
    built = build_entity(world({"r": rope}), "r", NO_ASSETS)
    assert sum(b.mass for b in built.bodies) == pytest.approx(0.5)
    assert len(built.bodies) == 20
    thick = entity(generator={"kind": "rope", "points": [(0, 0, 0), (1, 0, 0)], "radius": 0.1, "segments": 20})
    with pytest.raises(InputError, match="segments"):
        build_entity(world({"r": thick}), "r", NO_ASSETS)


def test_the_digest_of_a_built_entity_depends_on_its_content_only():
    spec = world({"a": box(0.1, 0.2, 0.3), "b": box(0.1, 0.2, 0.3, at=(1, 0, 0))})
    once, again = build_entity(spec, "a", NO_ASSETS), build_entity(spec, "a", NO_ASSETS)
    assert once.digest() == again.digest()
    assert once.recipe == build_entity(spec, "b", NO_ASSETS).recipe


def test_the_order_in_which_parts_are_written_does_not_count():
    """JSON objects have no order: a specification read back from a bundle, with sorted keys, gives the same bytes."""
    parts = {
        name: {"shape": {"kind": "box", "size": size}, "pose": {"position": at}}
        for name, size, at in (("top", (0.37, 0.11, 0.013), (0.1, 0.2, 0.3)), ("leg", (0.01, 0.017, 0.3), (-0.1, 0.07, 0.1)), ("arm", (0.2, 0.031, 0.05), (0.3, 0.1, -0.1)))
    }  # fmt: skip
    built = [
        build_entity(world({"a": entity(parts=dict(order))}), "a", NO_ASSETS) for order in (parts.items(), sorted(parts.items()))
    ]
    assert built[0].digest() == built[1].digest()
    assert built[0].recipe == built[1].recipe
