"""Water wheels, windmills and cranes."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import arc, circle
from .wheels import Axle, pierced

__all__ = ["GENERATORS"]


class WaterWheelParameters(Parameters):
    """A water wheel whose axle lies along x in two posts; water comes along y."""

    diameter: float = Field(default=2.0, ge=0.8, le=4.0, description="over the paddles [m]")
    width: float = Field(default=0.6, ge=0.25, le=1.2, description="of the wheel along x [m]")
    paddles: int = Field(default=16, ge=12, le=24, description="paddles, made a multiple of 4")
    buckets: bool = Field(default=False, description="a floor between the rims and slanting paddles, for water from above")
    clearance: float = Field(default=0.15, ge=0.05, le=0.6, description="of the wheel over the ground [m]")
    metal: str = material("mild_steel", "cast_iron", of="axle")
    material: str = material("oak", "larch", "pine")


def _water_wheel(p: WaterWheelParameters, rng: np.random.Generator) -> Made:
    body = Body("wheel stand", p.material)
    made = Made.of(body)
    r, half = p.diameter / 2, p.width / 2
    z = p.clearance + r
    wheel = made.bodies["wheel"] = Body("water wheel", p.material)
    axle = Axle((0, 0, z), "x")
    count = max(12, 4 * round(p.paddles / 4))
    step = 2 * math.pi / count
    board, inner = max(0.022, 0.03 * r), 0.78 * r
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * half, s * (half - board)))
        axle.ring(wheel, f"rim_{side}", [(inner, a), (r, a), (r, b), (inner, b)], segments=count)
    hub, long = 0.14 * r, half + 0.02
    spokes = count // 2
    axle.ring(wheel, "hub", [(0, -long), (hub, -long), (hub, long), (0, long)], segments=spokes, spin=step / 2 - math.pi / spokes)
    wide = min(0.85 * 2 * hub * math.sin(math.pi / spokes), 0.06 * r + 0.02, 0.9 * 2 * inner * math.sin(step / 2))
    flats = (hub * math.cos(math.pi / spokes), inner * math.cos(step / 2))
    for k in range(spokes):
        for s, side in ((-1, "left"), (1, "right")):
            offsets = sorted((s * (half - 0.1 * board), s * (half - 0.9 * board)))
            axle.bar(wheel, f"spoke_{side}_{k + 1}", flats, (2 * k + 0.5) * step, (wide, wide), (offsets[0], offsets[1]))
    room = (-half + board, half - board)
    thick = max(0.018, 0.018 * r)
    for k in range(count):
        angle = k * step
        low = inner
        if p.buckets:
            axle.sector(wheel, f"floor_{k + 1}", (inner, inner + thick), (angle, angle + step), room)
            low = inner + thick + 0.002
            lean = 0.45 * step
            points = [
                axle.at(q, angle + t, w)
                for q, t in ((low, 0.0), (low, 1.4 * thick / r), (0.985 * r, lean), (0.985 * r, lean + 1.4 * thick / r))
                for w in room
            ]
            wheel.hull(f"paddle_{k + 1}", points)
        else:
            axle.bar(wheel, f"paddle_{k + 1}", (low, 0.985 * r), angle, (thick, thick), room)
    _wheel_stand(made, axle, (r, half, long), p)
    made.joints["wheel"] = Joint("wheel", "hinge", (0, 0, z), axis=(1, 0, 0), damping=0.5, friction=0.5)
    return made


def _wheel_stand(made: Made, axle: Axle, sizes: tuple[float, float, float], p: WaterWheelParameters) -> None:
    """Posts with braces on sills, ties between them, and the journals that turn in the posts."""
    body, wheel, z = made.main, made.bodies["wheel"], axle.center[2]
    r, half, long = sizes
    x, post, pin = half + 0.12, 0.12, 0.045
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * (x + post)))
        top = z + 0.22
        pierced(body, f"post_{side}", (a, -post / 2, 0.1), (b, post / 2, top), (0, z), pin + 0.003)
        reach = 0.55 * r + 0.25
        body.box(f"sill_{side}", (a, -reach - 0.1, 0), (b, reach + 0.1, 0.1))
        for t, end in ((-1, "front"), (1, "back")):
            points = [
                (u, t * y, h)
                for u in (a + 0.02, b - 0.02)
                for y, h in ((reach, 0.1), (reach - 0.1, 0.1), (post / 2, 0.78 * z), (post / 2, 0.78 * z - 0.12 * z / reach))
            ]
            body.hull(f"brace_{side}_{end}", points)
        ends = sorted((s * long, s * (x + post + (0.08 if s > 0 else -0.003))))
        axle.ring(
            wheel, f"journal_{side}", [(0, ends[0]), (pin, ends[0]), (pin, ends[1]), (0, ends[1])], segments=16, material=p.metal
        )
    body.box(
        "bearing", (-x - post - 0.015, -0.4 * post, z - 0.4 * post), (-x - post, 0.4 * post, z + 0.4 * post), material=p.metal
    )
    for t, end in ((-1, "front"), (1, "back")):
        y = t * (0.55 * r + 0.2)
        body.box(f"tie_{end}", (-x, y - 0.05, 0), (x, y + 0.05, min(0.08, p.clearance - 0.01)))


class WindmillParameters(Parameters):
    """A post with a head that bears four sails; they turn about an axis along y at the front."""

    height: float = Field(default=3.0, ge=1.5, le=8.0, description="of the hub [m]")
    sail: float = Field(default=0.8, ge=0.5, le=0.9, description="length of a sail over the height of the hub")
    width: float = Field(default=0.24, ge=0.15, le=0.35, description="of a sail over its length")
    pitch_deg: float = Field(
        default=14.0, ge=5.0, le=25.0, description="of the sails from the plane in which they turn [degrees]"
    )
    cloth: bool = Field(default=True, description="cloth on the lattices")
    sailcloth: str = material("linen", "cotton", of="sails")
    metal: str = material("cast_iron", "mild_steel", of="shaft")
    material: str = material("oak", "larch", "pine")


def _windmill(p: WindmillParameters, rng: np.random.Generator) -> Made:
    body = Body("windmill post", p.material)
    made = Made.of(body)
    h, w = p.height, 0.05 * p.height + 0.05
    sill, reach = 0.8 * w, 0.25 * h
    body.box("sill_1", (-reach, -w / 2, 0), (reach, w / 2, sill))
    for t, side in ((-1, "front"), (1, "back")):
        a, b = sorted((t * w / 2, t * reach))
        body.box(f"sill_{side}", (-w / 2, a, 0), (w / 2, b, sill))
    top = h - 0.12 * h
    body.box("post", (-w / 2, -w / 2, sill), (w / 2, w / 2, top))
    for k in range(4):
        a = math.pi / 2 * k
        c, s = round(math.cos(a)), round(math.sin(a))
        line = [(reach - 0.02, sill), (reach - 0.02 - 0.8 * w, sill), (w / 2, 0.42 * h), (w / 2, 0.42 * h - 0.9 * w)]
        body.hull(f"brace_{k + 1}", [(c * u - s * v, s * u + c * v, z) for u, z in line for v in (-0.3 * w, 0.3 * w)])
    deep, wide = 0.12 * h, 0.09 * h
    body.box("head", (-wide, -deep, top), (wide, deep, h + 0.07 * h))
    roof = h + 0.07 * h
    body.hull(
        "roof",
        [
            (x, y, z)
            for y in (-1.12 * deep, 1.12 * deep)
            for x, z in ((-1.25 * wide, roof), (1.25 * wide, roof), (0, roof + 1.1 * wide))
        ],
        material="slate",
    )
    body.hull(
        "vane",
        [
            (x, y, z)
            for x in (-0.012, 0.012)
            for y, z in ((deep, h - 0.01), (deep, h + 0.02), (deep + 0.3 * h, h + 0.1 * h), (deep + 0.3 * h, h - 0.06 * h))
        ],
    )
    rotor = made.bodies["rotor"] = Body("sails", p.material)
    y = -deep - 0.16 * h
    axle = Axle((0, y, h), "y")
    hub = 0.032 * h + 0.02
    start = -deep - 0.002
    axle.ring(rotor, "shaft", [(0, hub), (0.5 * hub, hub), (0.5 * hub, start - y), (0, start - y)], segments=16, material=p.metal)
    inner = hub * math.cos(math.pi / 4)
    rotor.box("hub", (-inner, y - hub, h - inner), (inner, y + hub, h + inner))
    axle.ring(
        rotor, "nose", [(0, -1.8 * hub), (0.35 * hub, -1.5 * hub), (0.5 * hub, -hub), (0, -hub)], segments=16, material=p.metal
    )
    for k in range(4):
        _sail(
            rotor,
            (0, y, h),
            math.pi / 2 * k,
            (inner, min(p.sail * h, (h - sill - 0.05) / math.hypot(1.0, p.width + 0.04))),
            p,
            k + 1,
        )
    made.joints["rotor"] = Joint("rotor", "hinge", (0, y, h), axis=(0, 1, 0), damping=0.2, friction=0.3)
    return made


def _sail(
    body: Body, center: tuple[float, float, float], angle: float, reach: tuple[float, float], p: WindmillParameters, number: int
) -> None:
    """A spar with a pitched lattice and its cloth at the trailing side."""
    c, s = math.cos(angle), math.sin(angle)
    near, far = reach
    t = 0.018 * p.height + 0.008
    tilt = math.radians(p.pitch_deg)

    def at(u: float, v: float, w: float) -> tuple[float, float, float]:
        """A point u along the sail, v across it in its pitched plane, w off that plane."""
        across, out = v * math.cos(tilt) + w * math.sin(tilt), -v * math.sin(tilt) + w * math.cos(tilt)
        return (center[0] + c * u - s * across, center[1] + out, center[2] + s * u + c * across)

    def bar(
        name: str, us: tuple[float, float], vs: tuple[float, float], ws: tuple[float, float], material: str | None = None
    ) -> None:
        body.hull(f"{name}_{number}", [at(u, v, w) for u in us for v in vs for w in ws], material=material)

    half = t / 2
    lead = [
        (center[0] + c * near - s * v, center[1] + w, center[2] + s * near + c * v) for v in (-half, half) for w in (-half, half)
    ]
    root = near + 0.1 * far
    body.hull(f"root_{number}", [*lead, *(at(root, v, w) for v in (-half, half) for w in (-half, half))])
    bar("spar", (root, far), (-half, half), (-half, half))
    wide, begin, thin = p.width * (far - near), near + 0.22 * (far - near), 0.5 * half
    hems = (half + 0.5 * (wide - thin), half + wide)
    bars = 6
    for k in range(bars + 1):
        u = begin + (far - begin - thin) * k / bars
        bar(f"bar_{k + 1}", (u, u + thin), (half, half + wide), (-thin / 2, thin / 2))
    for j, v in enumerate(hems, start=1):
        bar(f"hem_{j}", (begin, far), (v - thin, v), (thin / 2, thin * 1.3))
    if p.cloth:
        bar("canvas", (begin, far), (half, half + wide), (-thin / 2 - 0.005, -thin / 2), p.sailcloth)


class CraneParameters(Parameters):
    """A slewing crane: a mast on a heavy foot, a jib that turns about it, a hook that swings."""

    height: float = Field(default=3.0, ge=1.2, le=6.0, description="of the mast [m]")
    jib: float = Field(default=0.7, ge=0.4, le=0.9, description="reach over the height of the mast")
    rope: float = Field(default=0.45, ge=0.2, le=0.6, description="length of the rope over the height of the mast")
    counterweight: bool = Field(default=True, description="a block on the jib's tail")
    metal: str = material("mild_steel", "cast_iron", of="fittings")
    material: str = material("oak", "mild_steel", "larch")


def _mast(p: CraneParameters, wide: float, foot: float, r: float, collars: tuple[float, float], segments: int) -> Body:
    """The mast of a crane on its foot, with the ledges that carry the collars of the jib."""
    body, h = Body("crane mast", p.material), p.height
    body.hull(
        "foot",
        [(s * a, t * a, z) for s in (-1, 1) for t in (-1, 1) for a, z in ((wide, 0.0), (wide, 0.6 * foot), (0.9 * wide, foot))],
        material="concrete_c30",
    )
    head = collars[1] + 0.05 * h
    body.turned("mast", [(0, foot), (r, foot), (r, head), (0, head)], segments=segments)
    for k, z in enumerate(collars, start=1):
        ring = [(r, z - 0.04 * h), (1.6 * r, z - 0.035 * h), (1.6 * r, z - 0.005 * h), (r, z - 0.005 * h)]
        body.turned(f"ledge_{k}", ring, segments=segments, material=p.metal)
    return body


def _crane(p: CraneParameters, rng: np.random.Generator) -> Made:
    h, r = p.height, 0.03 * p.height + 0.02
    foot, reach, wide, segments = 0.09 * h, p.jib * h, 0.32 * h, 24
    collars = (0.42 * h, 0.9 * h)
    made = Made.of(_mast(p, wide, foot, r, collars, segments))
    arm = made.bodies["jib"] = Body("crane jib", p.material)
    tall, outer = 0.05 * h, r + 0.003 + 0.4 * r
    flat = outer * math.cos(math.pi / segments)
    for k, z in enumerate(collars, start=1):
        lid = z + tall + 0.002 * (k == 2)
        ring = [(r + 0.003, z), (outer, z), (outer, lid), (r + 0.003, lid)]
        # A flat side of the ring faces the jib.
        arm.turned(f"collar_{k}", ring, segments=segments, euler=(0, 0, math.pi / segments), material=p.metal)
    cap = [
        (0, lid),
        (outer, lid),
        (outer, lid + 0.2 * r),
        (0.3 * r, lid + 0.6 * r),
        (0.35 * r, lid + 0.9 * r),
        (0, lid + 1.2 * r),
    ]
    arm.turned("cap", cap, segments=segments, euler=(0, 0, math.pi / segments), material=p.metal)
    half = min(0.4 * r, 0.9 * outer * math.sin(math.pi / segments))
    z = collars[1]
    arm.hull(
        "beam",
        [(x, y, b) for x, zs in ((flat, (z, z + tall)), (reach, (z + 0.3 * tall, z + tall))) for y in (-half, half) for b in zs],
    )
    end = 0.62 * reach
    under = z + 0.3 * tall * (end - flat) / (reach - flat)
    near = z + 0.3 * tall * (end - 0.08 * h - flat) / (reach - flat)
    low = collars[0]
    arm.hull(
        "strut",
        [
            (x, y, b)
            for x, b in ((flat, low + 0.1 * tall), (flat, low + 0.95 * tall), (end, under), (end - 0.08 * h, near))
            for y in (-half, half)
        ],
    )
    if p.counterweight:
        tail = 0.3 * reach
        arm.hull("tail", [(-x, y, b) for x in (flat, tail) for y in (-half, half) for b in (z, z + tall)])
        arm.box("weight", (-tail - 0.12 * h, -0.06 * h, z - 0.05 * h), (-tail, 0.06 * h, z + tall), material=p.metal)
    made.joints["jib"] = Joint("jib", "hinge", (0, 0, z), axis=(0, 0, 1), range=(-math.pi, math.pi), damping=2.0, friction=2.0)
    x, u = reach - 0.05 * h, min(0.008 + 0.002 * h, 0.65 * half)
    _hook(made, x, z + 0.3 * tall * (x - 1.2 * u - flat) / (reach - flat), u, ((flat, low), (end, under)), p)
    made.places["foot"] = Place((0.6 * wide, -0.6 * wide, foot), (0.3 * wide, 0.3 * wide))
    return made


def _hook(
    made: Made, x: float, under: float, u: float, strut: tuple[tuple[float, float], tuple[float, float]], p: CraneParameters
) -> None:
    """Rope with a weight and a hook, which swings between two lugs under the jib's end as far as mast and strut let it."""
    pivot = under - 4 * u
    for s, side in ((-1, "front"), (1, "back")):
        a, b = sorted((s * (u + 0.0015), s * (u + 0.008)))
        made.bodies["jib"].box(f"lug_{side}", (x - 1.2 * u, a, pivot - 1.5 * u), (x + 1.2 * u, b, under), material=p.metal)
    body = made.bodies["hook"] = Body("crane hook", p.metal)
    body.cylinder("eye", (x, -u, pivot), (x, u, pivot), 1.3 * u)
    end = pivot - p.rope * p.height
    body.cylinder("rope", (x, 0, pivot - 1.3 * u), (x, 0, end), 0.7 * u, material="cotton")
    body.turned(
        "weight",
        [(0, end - 5 * u), (1.5 * u, end - 5 * u), (3 * u, end - 3 * u), (3 * u, end - 1.5 * u), (u, end), (0, end)],
        (x, 0, 0),
        segments=20,
    )
    bow = 3 * u
    center = (x, end - 5 * u - 2 * u - bow)
    points = arc(center, bow, 0.5 * math.pi - 0.35, -0.95 * math.pi, 12)
    path = [(x, 0, end - 5 * u), (x, 0, end - 6 * u), *((a, 0, b) for a, b in points)]
    body.sweep("hook", path, circle(0.8 * u, 10), scales=[1.0] * (len(path) - 3) + [0.85, 0.7, 0.5])
    (x0, z0), (x1, z1) = strut
    long, rope = math.hypot(x1 - x0, z1 - z0), p.rope * p.height + 20 * u
    limit = 0.0
    for angle in np.linspace(0.02, 0.78, 39):
        points = [(x - t * rope * math.sin(angle), pivot - t * rope * math.cos(angle)) for t in np.linspace(0, 1, 30)]
        clear = min(((a - x0) * (z1 - z0) - (b - z0) * (x1 - x0)) / long for a, b in points[3:])
        if clear < 4.5 * u or points[-1][0] < 0.07 * p.height + 5 * u:
            break
        limit = float(angle)
    made.joints["hook"] = Joint(
        "hook", "hinge", (x, 0, pivot), parent="jib", axis=(0, 1, 0), range=(-0.78, limit), damping=0.05, friction=0.01
    )


GENERATORS = (
    Generator("water_wheel", "water wheel with paddles or buckets on a hinge between posts", WaterWheelParameters, _water_wheel,
              ("mill", "river", "stream", "millwheel", "paddle", "machine")),
    Generator("windmill", "windmill: a post with a head and four sails that turn", WindmillParameters, _windmill,
              ("sails", "rotor", "wind", "farm", "mill", "turbine")),
    Generator("crane", "crane with a jib that turns about its mast and a hook that swings", CraneParameters, _crane,
              ("harbour", "hoist", "lifting", "building", "site", "derrick")),
)  # fmt: skip
