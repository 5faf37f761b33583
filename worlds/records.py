"""Registry of recorded quantities: unit, meaning, sign, and whether physics conserves it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

__all__ = ["QUANTITIES", "Quantity"]

Category = Literal["rigid", "elastic", "blown", "cloth", "liquid", "surface", "fracture", "particles", "tearing"]


@dataclass(frozen=True)
class Quantity:
    """One per-frame quantity, written as channel `record/<name>`."""

    name: str
    unit: str
    meaning: str
    conserved: bool = False
    of: tuple[Category, ...] = ("rigid",)
    """Instances of these categories write it; `elastic`, `fracture`: rigid ones with elastic or breakable members; `blown`: with elastic ones that a force field acts on; `tearing`: cloth that can tear; `surface`: it stands beside the surfaces of a liquid."""


_BOTH: tuple[Category, ...] = ("rigid", "liquid", "cloth", "particles")
_DRIVEN: tuple[Category, ...] = ("rigid", "liquid", "particles")
_MOVED: tuple[Category, ...] = ("rigid", "liquid")
_CLOTH: tuple[Category, ...] = ("cloth",)
_LIQUID: tuple[Category, ...] = ("liquid",)
_ELASTIC: tuple[Category, ...] = ("elastic",)
_PARTICLES: tuple[Category, ...] = ("particles",)
_MATTER: tuple[Category, ...] = ("liquid", "particles")
_SURFACE: tuple[Category, ...] = ("surface",)
_ALL = (
    Quantity("kinetic_energy", "J", "sum over moving bodies, liquid or particles", of=_BOTH),
    Quantity("potential_energy", "J", "gravity, against z = 0, plus springs", of=_BOTH),
    Quantity("driver_work", "J", "work done by drivers since frame 0, positive into the bodies or the liquid", of=_DRIVEN),
    Quantity("momentum_x", "kg m/s", "sum over moving bodies or liquid", of=_BOTH),
    Quantity("momentum_y", "kg m/s", "sum over moving bodies or liquid", of=_BOTH),
    Quantity("momentum_z", "kg m/s", "sum over moving bodies or liquid", of=_BOTH),
    Quantity("driver_impulse_x", "kg m/s", "momentum that zones of waves gave to a liquid since frame 0", of=_LIQUID),
    Quantity("driver_impulse_y", "kg m/s", "momentum that zones of waves gave to a liquid since frame 0", of=_LIQUID),
    Quantity("driver_impulse_z", "kg m/s", "momentum that zones of waves gave to a liquid since frame 0", of=_LIQUID),
    *(
        Quantity(f"field_impulse_{a}", "kg m/s", "momentum that force fields gave to a liquid since frame 0", of=_LIQUID)
        for a in "xyz"
    ),
    Quantity("field_work", "J", "work that force fields did on a liquid since frame 0", of=_LIQUID),
    Quantity("mass", "kg", "sum over moving bodies; of a liquid, what is in the domain", conserved=True, of=_BOTH),
    Quantity("body_count", "1", "moving bodies", conserved=True),
    Quantity("max_speed", "m/s", "fastest centre of mass or particle over all steps of the frame", of=_BOTH),
    Quantity("max_travel_per_step", "m", "largest surface travel in one step of the frame"),
    Quantity("steps", "1", "solver steps taken in the frame", of=_BOTH),
    Quantity("step", "s", "time step used in the frame; of a liquid, their mean", of=_BOTH),
    Quantity("contacts_max", "1", "most contacts in one step of the frame; of cloth, near pairs", of=("rigid", "cloth")),
    Quantity("contact_gain", "J", "most energy that contacts of bodies that touch gave in one step of the frame; none is sound"),
    Quantity("iterations_max", "1", "most solver iterations in one step of the frame"),
    Quantity("iterations_capped", "1", "steps that ended at the iteration cap", of=_MOVED),
    Quantity("overflows", "1", "engine warnings: full contact or constraint buffers, bad states"),
    Quantity("joint_error", "m", "largest gap of a welded, hinged or sliding joint"),
    Quantity("strain_energy", "J", "stored in the deformation of elastic bodies", of=_ELASTIC),
    Quantity("elastic_kinetic_energy", "J", "sum over the nodes of elastic bodies", of=_ELASTIC),
    Quantity("elastic_potential_energy", "J", "gravity, against z = 0, of elastic bodies", of=_ELASTIC),
    Quantity("elastic_momentum_x", "kg m/s", "sum over the nodes of elastic bodies", of=_ELASTIC),
    Quantity("elastic_momentum_y", "kg m/s", "sum over the nodes of elastic bodies", of=_ELASTIC),
    Quantity("elastic_momentum_z", "kg m/s", "sum over the nodes of elastic bodies", of=_ELASTIC),
    Quantity(
        "elastic_travel_per_step", "m", "farthest that a node of an elastic body went in one step of the frame", of=_ELASTIC
    ),
    Quantity("soft_field_work", "J", "work of force fields on elastic bodies in the frame", of=("blown",)),
    Quantity("fracture_energy", "J", "of the bonds that broke since frame 0", of=("fracture",)),
    Quantity(
        "solve_residual",
        "1",
        "largest relative residual of the elastic solve that did not converge; 0 where all did",
        of=_ELASTIC,
    ),
    Quantity("surface_volume", "m^3", "inside the reconstructed surface of a liquid", of=_SURFACE),
    Quantity("surface_area", "m^2", "of that surface", of=_SURFACE),
    Quantity("surface_components", "1", "separate pieces of that surface, cavities not counted", of=_SURFACE),
    Quantity("spray_volume", "m^3", "of particles apart from the liquid, which the surface leaves out", of=_SURFACE),
    Quantity("volume", "m^3", "sum of the particles' volumes at rest density", of=_MATTER),
    Quantity("particles", "1", "particles in the domain", of=_MATTER),
    Quantity("density_error_mean", "1", "largest mean compression at the end of a step of the frame", of=_LIQUID),
    Quantity("density_error_max", "1", "largest compression at the end of a step of the frame", of=_LIQUID),
    Quantity("iterations_pressure", "1", "most iterations of the density or pressure solve in a step of the frame", of=_LIQUID),
    Quantity("iterations_divergence", "1", "most iterations of the divergence solve in a step of the frame", of=_LIQUID),
    Quantity("lost", "1", "particles that are no longer there and that nothing took away, since frame 0", of=_MATTER),
    Quantity("inflow_mass", "kg", "let in by inflows or emitters since frame 0", of=_MATTER),
    Quantity("outflow_mass", "kg", "taken away by outflows since frame 0", of=_LIQUID),
    Quantity("torn_length", "m", "of all open edges of cloth, at rest", of=("tearing",)),
    Quantity("stretch_energy", "J", "elastic, of stretch and shear of cloth", of=_CLOTH),
    Quantity("bending_energy", "J", "elastic, of the bending of cloth", of=_CLOTH),
    Quantity("stretch_max", "1", "largest extension of an edge of cloth over its length at rest", of=_CLOTH),
    Quantity("stretch_min", "1", "largest shortening of an edge of cloth over its length at rest, negative", of=_CLOTH),
    Quantity(
        "exchanges",
        "1",
        "times in the frame at which cloth or particles looked at the air and at bodies",
        of=("cloth", "particles"),
    ),
    Quantity(
        "cut_vertices", "1", "vertices of cloth whose way was cut short so that nothing crosses, over all exchanges", of=_CLOTH
    ),
    *(
        Quantity(f"{by}_impulse_{axis}", "kg m/s", f"momentum that {what} gave to cloth since frame 0", of=_CLOTH)
        for by, what in (
            ("air", "air and fields"),
            ("hold", "what holds vertices"),
            ("solid", "contact with solids"),
            ("cut", "ways cut short"),
        )
        for axis in "xyz"
    ),
    *(
        Quantity(f"{by}_work", "J", f"work of {what} on cloth since frame 0", of=_CLOTH)
        for by, what in (("air", "air and fields"), ("hold", "what holds vertices"), ("solid", "moving solids in contact"))
    ),
    Quantity("domain_outflow", "kg", "left the domain since frame 0", of=_MATTER),
    Quantity("rotation_energy", "J", "of the spins of particles", of=_PARTICLES),
    Quantity("wall_work", "J", "work of the motion of bodies on grains in contact since frame 0", of=_PARTICLES),
    Quantity("contact_energy", "J", "elastic energy of contacts by their depths, among grains and with bodies", of=_PARTICLES),
    Quantity("spring_energy", "J", "elastic energy of the springs that resist slip and rolling in contacts", of=_PARTICLES),
    Quantity("mean_speed", "m/s", "of all particles at the frame", of=_PARTICLES),
    Quantity("inflow_count", "1", "particles that emitters let out since frame 0", of=_PARTICLES),
    Quantity("died_count", "1", "particles that died at surfaces or of age since frame 0", of=_PARTICLES),
    Quantity("died_mass", "kg", "their mass", of=_PARTICLES),
    Quantity("outflow_count", "1", "particles that left the domain since frame 0", of=_PARTICLES),
)
QUANTITIES: Mapping[str, Quantity] = {q.name: q for q in _ALL}
