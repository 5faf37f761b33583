"""Which instances run together, and how a run of them is made."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from ..worlds.canonical import digest_of
from ..worlds.errors import EvidenceError, InputError
from ..worlds.instances import felt_by, membership_problems, read_by, watched_by
from ..worlds.media import media_of
from ..worlds.shapes import Pose
from .coupled_solver import CoupledSolver
from .engines import solver_class
from .protocol import Intervention, Solver, Within
from .recipes import coupled_recipe

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.cache import Cache
    from ..worlds.spec import WorldSpec
    from .airing import Aired
    from .coupling import CoupledRun

__all__ = ["Run", "make_run", "reads", "standing"]


def reads(spec: WorldSpec, *names: str) -> tuple[str, ...]:
    """Instances whose caches a group of instances reads while it runs."""
    return tuple(dict.fromkeys(r for name in names for r in read_by(spec, name)))


class Run:
    """Solvers that advance frame by frame together: one instance, or a group of coupled ones."""

    def __init__(self, solvers: Mapping[str, Solver], coupled: CoupledRun | Aired | None = None) -> None:
        self.solvers, self._coupled = solvers, coupled

    def prepare(self, *, resumed: bool = False, tell: Within | None = None) -> None:
        """The state at frame 0; `resumed` leaves out what a checkpoint restored next replaces. `tell` takes how far the preroll is."""
        if self._coupled is not None:
            self._coupled.prepare(resumed=resumed, tell=tell)
            return
        for solver in self.solvers.values():
            if isinstance(solver, CoupledSolver):
                solver.prepare(resumed=resumed, tell=tell)
            else:
                solver.prepare(resumed=resumed)

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance all from frame - 1 to `frame`; `tell` takes how far that is."""
        if self._coupled is not None:
            self._coupled.advance(frame, tell=tell)
            return
        for solver in self.solvers.values():
            solver.advance(frame, tell=tell)

    def restore(self, states: Mapping[str, bytes], frame: int) -> None:
        """Continue from checkpoints that were taken together at `frame`."""
        for name, solver in self.solvers.items():
            solver.restore(states[name], frame)


def standing(spec: WorldSpec, caches: Mapping[str, Cache]) -> WorldSpec:
    """The specification with single rigid bodies placed as they are at frame 0 of some caches, for what settles or flows around them."""
    entities = dict(spec.entities)
    for cache in caches.values():
        if cache.index.bodies and cache.index.solver in spec.simulation.rigid:
            first = cache.read(0, ("position", "quaternion"))
            owners = [n.split("/", 1) for n in cache.index.bodies]
            for (entity, body), place, turn in zip(owners, first["position"], first["quaternion"], strict=True):
                if body == "body" and entities[entity].physics.shape == "solid":
                    pose = Pose(position=tuple(map(float, place)), quaternion=tuple(map(float, turn)))
                    entities[entity] = entities[entity].model_copy(update={"pose": pose})
    return spec.model_copy(update={"entities": entities})


def make_run(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    names: tuple[str, ...],
    *,
    caches: Mapping[str, Cache] | None = None,
    intervention: Intervention | None = None,
    settled: Mapping[str, bytes] | None = None,
) -> Run:
    """The run of one group of `groups_of`, not yet prepared; with an intervention, of the run in which it is made.

    Args:
        spec: the specification.
        built: its geometry.
        names: the group.
        caches: of the instances that the group reads.
        intervention: what is done to it from outside.
        settled: states from which it starts instead of the declared ones, by instance, as a settle run left them.

    Raises:
        InputError: a member has no engine in this build.
        EvidenceError: what the group reads has no cache.
    """
    wrong = membership_problems(spec)
    if wrong:
        raise InputError(wrong[0].text)

    given = settled or {}
    have = _read(spec, names, caches or {})
    media = media_of(spec, have)

    def solver(name: str, **more: Any) -> Any:
        if name in given and "recipe" in more:
            more["recipe"] = digest_of(more["recipe"], hashlib.sha256(given[name]).hexdigest())
        made = solver_class(spec, name)(spec, built, name, intervention=intervention, media=media, **more)
        made.settled = given.get(name)
        return made

    rigid = names[0] in spec.simulation.rigid
    feeling = next((n for n in names if felt_by(spec, n)), None)
    if feeling is not None:
        # Made first: what it carries asks it, and not its cache.
        gas = solver(feeling, caches=have, recipe=coupled_recipe(spec, built))
        media = {**media, feeling: gas.live()}
        return _aired(gas, media[feeling], [n for n in names if n != feeling], solver, None if rigid else have)
    if len(names) > 1 and rigid:
        from .coupling import CoupledRun

        first, recipe = solver(names[0], coupled=True), coupled_recipe(spec, built)
        others = {n: solver(n, recipe=recipe) for n in names[1:]}
        return Run({names[0]: first, **others}, CoupledRun(first, list(others.values())))
    name = names[0]
    if rigid:
        return Run({name: solver(name)})
    recipe = solver_class(spec, name).recipe_alone(spec, built, name, have)
    if spec.simulation.settle is not None:
        spec = standing(spec, {n: c for n, c in have.items() if n not in watched_by(spec, name)})
    return Run({name: solver(name, caches=have, recipe=recipe)})


def _read(spec: WorldSpec, names: tuple[str, ...], caches: Mapping[str, Cache]) -> dict[str, Cache]:
    """Caches that a group reads."""
    wanted = reads(spec, *names)
    missing = sorted(n for n in wanted if n not in caches)
    if missing:
        raise EvidenceError(f"{names[0]!r} reads the motion of {missing[0]!r}, which has no cache; bake it first")
    return {n: caches[n] for n in wanted}


def _aired(
    gas: CoupledSolver, medium: Any, names: list[str], solver: Callable[..., Any], caches: Mapping[str, Cache] | None
) -> Run:
    """A run of a gas that feels what it carries: a rigid instance, which is the first, and others, or others that read bodies from caches.

    Args:
        gas: its solver.
        medium: as others meet it.
        names: of what runs with it.
        solver: makes one by its name.
        caches: of the instances that they read; None: the first is a rigid instance, which tells them.
    """
    from .airing import Aired, Airing

    airing, recipe = Airing(gas, medium), gas.recipe
    if caches is None:
        from .coupling import CoupledRun

        first, *rest = names
        rigid = solver(first, coupled=True)
        others = {n: solver(n, recipe=recipe) for n in rest}
        return Run({first: rigid, **others, gas.name: gas}, CoupledRun(rigid, list(others.values()), airing))
    alone = {n: solver(n, caches=caches, recipe=recipe) for n in names}
    return Run({gas.name: gas, **alone}, Aired(airing, list(alone.values())))
