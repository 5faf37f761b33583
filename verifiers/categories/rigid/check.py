"""Rigid bodies (R103, R104). The paper names records for them but no check (S11); ours are these, per instance:

- `category:rigid:bodies:<solver>` and `:mass:`: number and mass of moving bodies stay what construction built.
- `category:rigid:joints:<solver>`: no joint comes apart by more than `JOINT_GAP` or `JOINT_SHARE` of the body.
- `category:rigid:energy:<solver>`: kinetic + potential energy - work of drivers, liquids and fields never grows over any interval by
  more than `limits.energy_growth` of the energy that is in play: the largest kinetic energy plus the range of the
  potential energy. Contacts, friction and damping only take energy away, so a growth has no source.
- `category:rigid:escape:<solver>`: no body leaves a cube `ESCAPE` times the scene's largest extent, unless a
  predicate sends it there.

- `category:rigid:impact_energy:<solver>`: no contact gives energy, in no step and no frame (`categories/rigid/impacts.py`).

Laws of motion on the instance's ledgers (`ledgers/balance.py`): `categories/rigid/laws.py`; of contact: `categories/rigid/contacts.py`, `categories/rigid/bounces.py`; the records against
the ledgers: `categories/rigid/books.py`. Friction and restitution are judged where frames decide them: a body that slides straight for a
whole frame, a ball that hits once in one. Elsewhere impulses bound them, and what returns more than it got shows in the energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.candidate import Candidate
from ....worlds.predicates import Crosses, Displacement, Reaches, StaysIn, entities_of
from ....worlds.requirements import Row, RowId
from ....worlds.spec import BoxRegion, CylinderRegion, SphereRegion
from ...ledgers import motion
from ...ledgers.balance import books_of
from ...rows.corrections import correction
from ...rows.findings import Finding, cache_of, judged
from ...rows.verdicts import answered
from ..elastic.exchange import outside_work
from ..elastic.ledger import elastic_energies
from . import books as rigid_books
from . import bounces as rigid_bounces
from . import contacts as rigid_contacts
from . import fields as rigid_fields
from . import impacts as rigid_impacts
from . import laws as rigid_laws
from .joints import openings

if TYPE_CHECKING:
    from collections.abc import Callable

    from ....worlds.cache import Cache

__all__ = [
    "ESCAPE",
    "JOINT_GAP",
    "JOINT_SHARE",
    "MASS_NOISE",
    "category_rows",
    "energy_scale",
    "largest_growth",
    "moves_nothing",
]

MASS_NOISE = 1e-9
"""Relative; a sum of doubles in another order."""
JOINT_GAP = 1e-3
"""[m] Own choice: below what a picture of the scene resolves."""
JOINT_SHARE = 0.01
"""Own choice: of the smallest jointed body's diagonal, for large bodies."""
ESCAPE = 10.0
"""Own choice: ten scene sizes away nothing that belongs to the story happens."""
ROUNDING = 1e-9
"""Relative; the ledger's own energies speak where they show more growth than the records."""
REST_HEIGHT = 1e-3
"""[m] Energy scale of a scene where nothing moves: all its weight times this height."""


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """The rows of one instance; `unverified` where a record is missing."""
    checks: dict[str, Callable[[Candidate, str, Cache], Finding]] = {
        "bodies": _bodies,
        "mass": _mass,
        "joints": _joints,
        "energy": _energy,
        "escape": _escape,
        "records": rigid_books.records,
        "work": rigid_books.work,
        "momentum": rigid_laws.momentum,
        "motion": rigid_laws.motion,
        "spin": rigid_laws.spin,
        "turning": rigid_laws.turning,
        "driven": rigid_laws.driven,
        "contacts": rigid_contacts.contacts,
        "friction": rigid_contacts.friction,
        "restitution": rigid_bounces.restitution,
        "impact_energy": rigid_impacts.impact_energy,
        "fields": rigid_fields.fields,
    }
    return [
        answered(
            candidate,
            RowId(f"category:rigid:{name}", solver),
            PREDICATES[name],
            judged(_ask, function, candidate, solver),
            extra=[candidate.spec.simulation.limits.energy_growth],
        )
        for name, function in checks.items()
    ]


def _ask(function: Callable[[Candidate, str, Cache], Finding], candidate: Candidate, solver: str) -> Finding:
    cache = cache_of(candidate, solver)
    if moves_nothing(candidate, solver, cache):
        return Finding("not_applicable", f"no rigid member of {solver!r} moves")
    return function(candidate, solver, cache)


def moves_nothing(candidate: Candidate, solver: str, cache: Cache) -> bool:
    """Whether an instance holds no rigid body but ground: by the plan, and by the index of its cache."""
    members = [candidate.spec.entities[m] for m in candidate.spec.simulation.solvers[solver].members]
    return not cache.index.bodies and all(e.motion == "static" or e.physics.category == "elastic" for e in members)


PREDICATES = {
    "bodies": "number of moving bodies is constant and as built",
    "mass": "mass of moving bodies is constant and as built",
    "joints": f"largest joint gap <= max({JOINT_GAP:g} m, {JOINT_SHARE:g} of the smallest jointed body)",
    "energy": "mechanical energy less the work of drivers, liquids and fields never grows by more than limits.energy_growth of the energy in play",
    "escape": f"every body stays within {ESCAPE:g} scene sizes",
    **rigid_books.PREDICATES,
    **rigid_laws.PREDICATES,
    **rigid_contacts.PREDICATES,
    **rigid_bounces.PREDICATES,
    **rigid_impacts.PREDICATES,
    **rigid_fields.PREDICATES,
}


def _owners(cache: Cache) -> list[str]:
    return [name.split("/", 1)[0] for name in cache.index.bodies]


def _deviating(series: F64, expected: float, noise: float) -> int | None:
    """First frame at which the series is not `expected`; a value that is not finite is not."""
    wrong = ~(np.abs(series - expected) <= noise)
    return int(np.argmax(wrong)) if wrong.any() else None


def _free(candidate: Candidate, cache: Cache) -> list[str]:
    """Bodies that are not on authored paths; only their mass and energy are in the records."""
    kinematic = {n for n, e in candidate.spec.entities.items() if e.motion == "kinematic"}
    return [b for b in cache.index.bodies if b.split("/", 1)[0] not in kinematic]


def _bodies(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    still = [n for n in _owners(cache) if n not in candidate.spec.entities or candidate.spec.entities[n].motion == "static"]
    if still:
        text = f"the cache moves {still[0]}, which is declared static or not at all"
        again = correction("the cache is of another specification", "interval", "bake again", pointers=("/simulation/frames",))
        return Finding("fail", text, entities=(still[0],), entity=still[0], frame=0, hints=(again,))
    return _constant(candidate, solver, cache, "bodies", "body_count", float(len(cache.index.bodies)), 0.0, "1")


def _mass(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    built = sum(candidate.body(*b.split("/", 1)).mass for b in _free(candidate, cache))
    return _constant(candidate, solver, cache, "mass", "mass", built, MASS_NOISE * max(built, 1e-12), "kg")


def _constant(
    candidate: Candidate, solver: str, cache: Cache, name: str, record: str, expected: float, noise: float, unit: str
) -> Finding:
    series: F64 = cache.series(f"record/{record}")
    frame = _deviating(series, expected, noise)
    worst = float(np.abs(series - expected).max()) if frame is not None and np.isfinite(series).all() else 0.0
    named = "" if unit == "1" else f" {unit}"
    text = f"{record} is {expected:.9g}{named} at all {len(series)} frames"
    if frame is not None:
        text = f"{record} is {series[frame]:.9g}{named} at frame {frame}, built were {expected:.9g}{named}"
    hints = (
        correction(
            "the engine lost or added a body",
            "step",
            "look at the engine's warnings before that frame; halve the step",
            pointers=(f"/simulation/solvers/{solver}/settings/step",),
        ),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst if frame is None or np.isfinite(series).all() else None,
        bound=noise,
        unit=unit,
        entities=tuple(dict.fromkeys(_owners(cache))),
        frame=frame,
        entity=_owners(cache)[0] if frame is not None and cache.index.bodies else None,
        hints=hints,
        evidence={"expected": expected, "record": f"record/{record}"},
    )


def _joints(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    plan = candidate.spec.simulation
    members = set(cache.index.colliders) | set(_owners(cache))
    jointed = {n: j for n, j in plan.joints.items() if j.kind != "spring" and j.child in members}
    ropes = [n for n, e in candidate.spec.entities.items() if e.generator is not None and n in members]
    if not jointed and not ropes:
        text = "the plan has no hinge, slide, ball or weld and no rope in this instance"
        return Finding("not_applicable", text)
    books = books_of(candidate, cache)
    sizes: dict[str, float] = {}
    for name in [*(j.child for j in jointed.values()), *ropes]:
        for body in candidate.entity(name).bodies:
            parts = candidate.entity(name).parts_of(body.name)
            points = np.concatenate([p.render.vertices for p in parts]) if parts else np.zeros((1, 3))
            sizes[name] = min(sizes.get(name, np.inf), float(np.linalg.norm(np.ptp(points, axis=0))))
    smallest = min(sizes, key=lambda n: sizes[n])
    bounds = {n: max(JOINT_GAP, JOINT_SHARE * size) for n, size in sizes.items()}
    # The record is the largest gap of all that the engine solves; poses show every joint by itself.
    series: F64 = books.record("joint_error")
    cases = [(smallest, "of the records", series), *((o.child, o.name, o.gap) for o in openings(books) if o.child in bounds)]
    worst, culprit, frame, bound, which = -1.0, None, None, bounds[smallest], ""
    for child, joint, gap in cases:
        wrong = ~((gap <= bounds[child]) | (np.isnan(gap) if gap is not series else False))
        value = float(np.nanmax(gap, initial=0.0)) if np.isfinite(gap[~np.isnan(gap)]).all() else np.inf
        first = int(np.argmax(wrong)) if wrong.any() else None
        if (first is not None, value / bounds[child]) > (frame is not None, worst):
            worst, culprit, frame, bound, which = value / bounds[child], child, first, bounds[child], joint
    largest_gap = worst * bound if np.isfinite(worst) and np.isfinite(series).all() else None
    text = f"largest joint gap, {which}, {'not finite' if largest_gap is None else f'{largest_gap:.3g} m'} against {bound:.3g} m"
    step = f"/simulation/solvers/{solver}/settings/step"
    hints = (
        correction("joints give way under the load", "step", "halve the step, or raise the iterations", pointers=(step,)),
        correction("the load is too large for the jointed masses", "mass", "bring the masses of jointed bodies closer together"),
    )
    return Finding(
        "fail" if frame is not None else "pass",
        text + (f", first over it at frame {frame}" if frame is not None else ""),
        measured=largest_gap,
        bound=bound,
        unit="m",
        entities=tuple(sizes),
        entity=culprit if frame is not None else None,
        frame=frame,
        hints=hints,
        evidence={"joints": list(jointed), "ropes": ropes, "smallest_body": sizes[smallest]},
    )


def energy_scale(kinetic: F64, potential: F64, weight: float) -> float:
    """Energy in play [J]: largest kinetic energy plus the range of the potential energy.

    At least the weight [N] times `REST_HEIGHT`, so that the noise of a scene at rest is not magnified.
    """
    k, p = kinetic[np.isfinite(kinetic)], potential[np.isfinite(potential)]
    return max(float(k.max(initial=0.0)) + (float(np.ptp(p)) if len(p) else 0.0), weight * REST_HEIGHT, 1e-12)


def largest_growth(energy: F64) -> tuple[float, int, int]:
    """Largest rise of a series over any interval, and the frames between which it rises."""
    lowest = np.minimum.accumulate(energy)
    rise = energy - lowest
    end = int(np.argmax(rise))
    return float(rise[end]), int(np.argmin(energy[: end + 1])), end


def _energy(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    kinetic, potential, work = (cache.series(f"record/{n}") for n in ("kinetic_energy", "potential_energy", "driver_work"))
    # Elastic members and rigid ones give energy to each other: both count.
    moving, stored = elastic_energies(cache)
    kinetic, potential = kinetic + moving, potential + stored
    plan = candidate.spec.simulation
    weight = sum(candidate.body(*b.split("/", 1)).mass for b in _free(candidate, cache)) * float(np.linalg.norm(plan.gravity))
    outside = outside_work(candidate, cache)
    given = work + outside.work + outside.doubt
    energy = kinetic + potential - given
    noise = rigid_books.authored_noise(books_of(candidate, cache))
    scale = max(energy_scale(kinetic, potential, weight), noise)
    bound = plan.limits.energy_growth
    broken = ~np.isfinite(energy)
    frame: int | None
    step = f"/simulation/solvers/{solver}/settings/step"
    if broken.any():
        frame = int(np.argmax(broken))
        hint = correction("the solver diverged", "step", "halve the step", pointers=(step,))
        text = f"energy is not finite at frame {frame}"
        return Finding("fail", text, frame=frame, hints=(hint,))
    own_kinetic, own_potential = rigid_books.energies(books_of(candidate, cache))
    own_kinetic, own_potential = own_kinetic + moving, own_potential + stored
    own = own_kinetic + own_potential - given
    own_scale = max(energy_scale(own_kinetic, own_potential, weight), noise)
    if largest_growth(own)[0] / own_scale > largest_growth(energy)[0] / scale + ROUNDING:
        energy, scale = own, own_scale
    growth, low, high = largest_growth(energy)
    over = energy - np.minimum.accumulate(energy) > bound * scale
    frame = int(np.argmax(over)) if over.any() else None
    text = f"energy rises by at most {growth:.3g} J (frames {low}..{high}), {growth / scale:.2%} of the {scale:.3g} J in play"
    entity = _gainer(candidate, cache, frame) if frame is not None else None
    if frame is not None:
        text += f"; over {bound:.2%} first at frame {frame}, where {entity} gains most"
    hints = (
        correction(
            "stiff contacts or joints put energy in: the step is too long",
            "step",
            "halve the step",
            pointers=(step,),
            patch=(
                {
                    "op": "add",
                    "path": step,
                    "value": round(max(2e-5, candidate.spec.simulation.rigid[solver].settings.step / 2), 9),
                },
            ),
        ),
        correction(
            "colliders overlap and push each other apart",
            "placement",
            f"look at {entity} at frame {frame}: separate what overlaps",
            pointers=(f"/entities/{entity}/pose",),
        ),
        correction(
            "contacts are too stiff for the step", "contact", "raise contact_steps", pointers=(step[:-4] + "contact_steps",)
        ),
    )
    return Finding(
        "fail" if frame is not None else "pass",
        text,
        measured=growth / scale,
        bound=bound,
        unit="1",
        entities=tuple(dict.fromkeys(_owners(cache))),
        entity=entity,
        frame=frame,
        hints=hints if frame is not None else (),
        evidence={
            "growth_J": growth,
            "scale_J": scale,
            "interval": [low, high],
            "start_J": float(energy[0]),
            "end_J": float(energy[-1]),
        },
    )


def _gainer(candidate: Candidate, cache: Cache, frame: int) -> str:
    """Entity whose kinetic energy, computed from velocities and masses, grew most in the frame."""
    own = motion.kinetic_energy(candidate, cache)
    gain = own[frame] - own[max(0, frame - 1)]
    return _owners(cache)[int(np.nanargmax(gain))] if len(gain) and np.isfinite(gain).any() else "?"


def _escape(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    low, high = motion.scene_box(candidate)
    middle, extent = (low + high) / 2, float((high - low).max())
    bound = ESCAPE * extent / 2
    sent = _sent_away(candidate, middle, bound)
    worst, culprit, at, checked = 0.0, None, None, []
    for name in dict.fromkeys(_owners(cache)):
        if name in sent:
            continue
        checked.append(name)
        away = np.abs(motion.centers(candidate, name) - middle).max(axis=1)
        outside = ~(away <= bound)
        if outside.any() and (at is None or int(np.argmax(outside)) < at):
            culprit, at = name, int(np.argmax(outside))
        worst = max(worst, float(np.nanmax(away, initial=0.0)))
    text = f"bodies stay within {worst:.3g} m of the middle of the scene ({extent:.3g} m large)"
    if culprit is not None:
        text = f"{culprit} is more than {bound:.3g} m from the middle of the scene from frame {at} on (at most {worst:.3g} m)"
    hints = (
        correction(
            "bodies are thrown out: they start overlapping", "placement", f"separate {culprit} from its neighbours at frame 0"
        ),
        correction(
            "contacts are resolved too late", "step", "halve the step", pointers=(f"/simulation/solvers/{solver}/settings/step",)
        ),
        correction("nothing holds it", "placement", f"put a support under {culprit}", pointers=(f"/entities/{culprit}/pose",)),
    )
    return Finding(
        "fail" if culprit is not None else "pass",
        text,
        measured=worst,
        bound=bound,
        unit="m",
        entities=tuple(checked),
        entity=culprit,
        frame=at,
        hints=hints if culprit is not None else (),
        evidence={"middle": middle, "extent": extent, "sent_away": sorted(sent)},
    )


def _sent_away(candidate: Candidate, middle: F64, bound: float) -> set[str]:
    """Entities that a predicate of the story sends beyond the box: a far region or plane, a large displacement."""
    story, regions = candidate.spec.story, candidate.spec.graph.regions
    predicates = [b.predicate for b in story.beats.values()] + [r.predicate for r in story.requirements.values()]
    found: set[str] = set()
    for predicate in predicates:
        goal: F64 | None = None
        if isinstance(predicate, Reaches | StaysIn):
            region = regions.get(predicate.region)
            if isinstance(region, BoxRegion) and region.relative_to is None:
                goal = (np.array(region.min) + np.array(region.max)) / 2
            elif isinstance(region, CylinderRegion | SphereRegion) and region.relative_to is None:
                goal = np.array(region.center)
        elif isinstance(predicate, Crosses):
            goal = np.array(predicate.point)
        far = goal is not None and bool((np.abs(goal - middle) > bound).any())
        if isinstance(predicate, Displacement):
            far = predicate.min is not None and predicate.min > bound
        if far:
            found |= set(entities_of(predicate))
    return found
