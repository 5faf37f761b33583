"""Evaluators of predicates, one per kind, joined one to one with `worlds.predicates.PREDICATES` by EVALUATORS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.predicates.registry import PREDICATES
from ..categories import flows, vessels
from ..categories.cloth import events as cloth_events
from ..categories.cloth import flutter
from ..categories.cloth import predicates as cloth
from ..categories.elastic import events as elastic_events
from ..categories.elastic import predicates as elastic
from ..categories.fracture import events as fracture_events
from ..categories.fracture import predicates as fracture
from ..categories.gas import events as gas_events
from ..categories.gas import flames
from ..categories.gas import predicates as gas
from ..categories.gas.judge import GasJudge
from ..categories.liquid import deeds as liquid_deeds
from ..categories.liquid import floating, splashing
from ..categories.liquid import predicates as liquid
from ..categories.liquid.judge import LiquidJudge
from ..categories.particles import events as particle_events
from ..categories.particles import predicates as particle
from . import combine, comparing, kinematic, landscape, touching
from .events import EVENTS
from .outcome import Outcome, missing
from .scope import Beats, Evaluator, Scope
from .times import BeatTimes

if TYPE_CHECKING:
    from ...worlds.spec import SpecModel

__all__ = ["EVALUATORS", "beat_times", "evaluate"]

EVALUATORS: Mapping[str, Evaluator] = {
    "reaches": kinematic.reaches,
    "stays_in": kinematic.stays_in,
    "crosses": kinematic.crosses,
    "contact": touching.contact,
    "no_contact": touching.no_contact,
    "rests_on": touching.rests_on,
    "supported": touching.supported,
    "tilts": kinematic.tilts,
    "topples": kinematic.topples,
    "speed": kinematic.speed,
    "displacement": kinematic.displacement,
    "separation": touching.separation,
    "joint_angle": kinematic.joint_angle,
    **EVENTS,
    "compares": comparing.compares,
    "deflection": elastic.deflection,
    "strain": elastic.strain,
    "bends": elastic_events.bends,
    "stretches": elastic_events.stretches,
    "wobbles": elastic_events.wobbles,
    "landscape_water": landscape.landscape_water,
    "landscape_field": landscape.landscape_field,
    "liquid_volume_in": liquid.liquid_volume_in,
    "liquid_level_at": liquid.liquid_level_at,
    "liquid_flux_through": liquid.liquid_flux_through,
    "liquid_arrives": liquid.liquid_arrives,
    "submerged_fraction": liquid.submerged_fraction,
    "wet_area": liquid.wet_area,
    "splash_height": liquid.splash_height,
    "liquid_speed": liquid.liquid_speed,
    "liquid_temperature": liquid.liquid_temperature,
    "floats": floating.floats,
    "bobs": floating.bobs,
    "sinks": floating.sinks,
    "pours": vessels.pours,
    "fills": vessels.fills,
    "overflows": vessels.overflows,
    "leaks": vessels.leaks,
    "splashes": splashing.splashes,
    "flows": flows.flows,
    "spreads": flows.spreads,
    "particle_count_in": particle.particle_count_in,
    "particle_volume_in": particle.particle_volume_in,
    "pile_height": particle.pile_height,
    "run_out": particle.run_out,
    "particles_settled": particle.particles_settled,
    "buries": particle_events.buries,
    "gas_density_in": gas.gas_density_in,
    "gas_temperature_in": gas.gas_temperature_in,
    "plume_height": gas.plume_height,
    "gas_arrives": gas.gas_arrives,
    "light_through": gas.light_through,
    "gas_clears": gas.gas_clears,
    "heat_release": flames.heat_release,
    "burnt_share": flames.burnt_share,
    "burns": flames.burns,
    "goes_out": flames.goes_out,
    "broken": fracture.broken,
    "breach": fracture.breach,
    "debris": fracture.debris,
    "cracks": fracture_events.cracks,
    "breaks": fracture_events.breaks,
    "drape": cloth.drape,
    "flutters": flutter.flutters,
    "torn": cloth.torn,
    "pinned": cloth.pinned,
    "tears": cloth_events.tears,
    "count": combine.count,
    "always": combine.always,
    "eventually": combine.eventually,
    "until": combine.until,
    "before": combine.before,
    "after": combine.after,
    "within": combine.within,
    "and": combine.and_,
    "or": combine.or_,
    "not": combine.not_,
}
OWN: Mapping[str, Mapping[str, Evaluator]] = {GasJudge.name: gas_events.EVENTS, LiquidJudge.name: liquid_deeds.EVENTS}
"""By category, kinds of event that such matter meets by a definition of its own."""


def evaluate(candidate: Candidate, predicate: SpecModel, frames: tuple[int, int], *, beats: Beats | None = None) -> Outcome:
    """Judge a predicate over the frames [first, last], inclusive.

    Missing channels, frames or geometry give `unverified`; coordinates that are not finite give `fail`.

    Args:
        candidate: what is judged.
        predicate: any predicate model.
        frames: the interval; frames that the candidate does not hold make the outcome `unverified`.
        beats: first true frames of the story's beats, for `before`, `after` and `within`; default the candidate's own.
    """
    kind = str(getattr(predicate, "kind", type(predicate).__name__))
    subject = candidate.spec.entities.get(str(getattr(predicate, "entity", "")))
    own = OWN.get(subject.physics.category, {}) if subject is not None else {}
    evaluator = own.get(kind, EVALUATORS.get(kind))
    unit = PREDICATES[kind].unit if kind in PREDICATES else "1"
    if evaluator is None:
        return missing(frames, unit, f"there is no evaluator for predicate kind {kind!r}")
    if frames[0] < 0 or frames[1] > candidate.last_frame:
        held = f"the {candidate.stage} holds frames 0..{candidate.last_frame}"
        return missing(frames, unit, f"frames {frames[0]}..{frames[1]} are needed and {held}")
    times = beats if beats is not None else beat_times(candidate)

    def nested(inner: SpecModel, span: tuple[int, int]) -> Outcome:
        return evaluate(candidate, inner, span, beats=times)

    try:
        return evaluator(Scope(candidate, frames, times, nested), predicate)
    except EvidenceError as error:
        return missing(frames, unit, str(error))


def beat_times(candidate: Candidate) -> BeatTimes:
    """The candidate's beats, evaluated at most once however many verifiers ask."""
    return candidate.memo("beat times", lambda: BeatTimes(candidate, lambda c, p, f, b: evaluate(c, p, f, beats=b)))
