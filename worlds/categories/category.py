"""The declaration of one category of matter."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ..channel import Channel
from ..matter import Instance, Matter, MatterShape
from ..parameters import PHYSICS, GroupInfo, Parameter
from ..predicate_base import PredicateInfo
from ..problems import Problem
from ..vocabulary import SpecModel
from .caps import Cap

if TYPE_CHECKING:
    from ..fields import Carrier, Frames
    from ..spec import Coupling, Entity, WorldSpec

__all__ = ["Audit", "Cap", "CategorySpec", "declares"]


@dataclass(frozen=True)
class Audit:
    """A row of the audit about one category."""

    row: str
    """Id of the row, without `audit:`."""
    predicate: str
    problems: Callable[[WorldSpec], list[Problem]]
    also: Callable[[WorldSpec], bool] = lambda spec: False
    """Function of a specification: true if the row is asked for where no entity and no instance is of the category."""


@dataclass(frozen=True)
class CategorySpec:
    """One category of matter. All callables read the specification alone."""

    name: str
    shape: MatterShape
    covers: str = ""
    """Matter that its engines simulate, for the list of capabilities; empty where none does."""
    physics: type[Matter] | None = None
    """Its member of the union `Physics`; None for what entities of other categories declare beside their physics."""
    contract: str = ""
    """Without `physics`: the field of an entity that declares it."""
    instances: tuple[type[Instance], ...] = ()
    """Its members of the union `SolverInstance`; empty where the instances of another category move it, or none do."""
    drivers: tuple[type[SpecModel], ...] = ()
    """Its members of the union `Driver`."""
    predicates: tuple[PredicateInfo, ...] = ()
    """Kinds of predicates that it answers."""
    meets: tuple[str, ...] = ()
    """Kinds of event of bodies that matter of it meets, which is no body, by a definition of its own."""
    asked: str = ""
    """Predicates that can be asked of matter that is no body, for the audit; empty for bodies."""
    groups: tuple[GroupInfo, ...] = ()
    """Causal parameter groups of its own."""
    parameters: tuple[Parameter, ...] = ()
    """Its fields, each with group and direction."""
    channels: Mapping[str, tuple[Channel, ...]] = field(default_factory=dict)
    """Channels that it writes into caches, by kind of writer: its name for all of its own instances, others as `writers` tells."""
    dimensions: Mapping[str, str] = field(default_factory=dict)
    """Named sizes of these channels that no other category has, and what their rows are."""
    changes: Callable[[WorldSpec, str], Iterable[str]] = lambda spec, name: ()
    """Entities besides its members that an instance of it changes, and may tell of in the story."""
    writers: Callable[[WorldSpec, str], Iterable[str]] = lambda spec, name: ()
    """More kinds of writer that an instance is."""
    knobs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """By engine: lengths in an entity's `physics` that a probe may leave coarser."""
    caps: tuple[Cap, ...] = ()
    estimate: Callable[[WorldSpec], Mapping[str, float]] = lambda spec: {}
    """Amounts that its instances take, by name of the cap."""
    audit: Audit | None = None
    warnings: Callable[[WorldSpec], Iterable[Problem]] = lambda spec: ()
    """Things that will probably fail once they are simulated; no problems of the specification, so that nothing is refused."""
    masses: Callable[[WorldSpec, str], Iterable[Problem]] = lambda spec, entity: ()
    """Problems of the declared mass of an entity of it."""
    bodies: Callable[[Entity], int] = lambda entity: 1
    """Number of bodies that an entity of it becomes."""
    rest_way: Callable[[WorldSpec, str], float] = lambda spec, entity: 0.0
    """Farthest that an entity of it at rest may move in half a second, by what its engine resolves [m]; 0 where none comes to rest by itself."""
    starts_alone: bool = False
    """An entity of it with a velocity at frame 0 moves without any cause, so that a beat has to tell of that."""
    coupling: Callable[[WorldSpec, str, Coupling], Iterable[Problem]] | None = None
    """Problems of a coupling of its instance to one that is not rigid, or of one by which its medium carries another; None where no engine couples these."""
    medium: Callable[[WorldSpec, str, Frames], Carrier] | None = None
    """The medium that an instance moved, from its cache; of categories whose instances carry others."""
    unrecorded: Callable[[WorldSpec, str, str], str] = lambda spec, a, b: ""
    """Why no record tells contacts of two entities of which one is of it, and what to ask instead; empty where one does."""
    unstruck: str = ""
    """Why no record tells when and how fast its contacts with bodies begin, and what to ask instead; empty where one does."""
    recipes: Callable[[WorldSpec, str], Mapping[str, str]] = lambda spec, motion: {}
    """Recipes of its own artifacts by name, given that of the motion."""
    weakenings: Callable[[str, Mapping[str, Any], Mapping[str, Any]], Iterable[str]] = lambda place, old, new: ()
    """Edits of an entity's physics that ask for less and that no direction tells: pointer of the physics, before, after."""
    eased: Callable[[str, Entity, Entity], Iterable[str]] = lambda name, old, new: ()
    """Edits of an entity by which it is easier to judge and that no direction tells: its name, before, after."""
    pieces: Callable[[Entity], int] = lambda entity: 0
    """Convex pieces with which a body of an entity collides, about; 0 where none are made."""
    seconds: Callable[[WorldSpec], float | None] = lambda spec: None
    """Seconds that its instances take by a usual rate, told before anything was measured; None where none is known."""

    @property
    def allowances(self) -> list[str]:
        """Fields of its physics that bound what is allowed: larger ones ask for less."""
        allowed = [p for p in self.parameters if p.way.direction == "harder_down" and p.pointer.startswith(f"{PHYSICS}/")]
        return [p.pointer.removeprefix(f"{PHYSICS}/") for p in allowed]


def declares(category: CategorySpec, entity: Entity) -> bool:
    """True if an entity is of a category."""
    if category.physics is None:
        return getattr(entity, category.contract) is not None
    return isinstance(entity.physics, category.physics)
