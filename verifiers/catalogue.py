"""Catalogue of all questions that checks ask: one table per folder, joined here explicitly. `docs/rows.md` is written from it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType, ModuleType

from .categories import questions as categories
from .categories.cloth import questions as cloth
from .categories.elastic import questions as elastic
from .categories.fracture import questions as fracture
from .categories.gas import questions as gas
from .categories.liquid import questions as liquid
from .categories.particles import questions as particles
from .categories.rigid import questions as rigid
from .claims import questions as claims
from .claims.described import questions as described
from .contact import questions as contact
from .delivery import questions as delivery
from .land import questions as land
from .review import questions as review
from .routes import questions as routes
from .rows.questions import Question
from .scene import questions as scene
from .shots import questions as shots
from .story import questions as story
from .support import questions as support
from .things import questions as things

__all__ = ["QUESTIONS", "TABLES"]

TABLES: tuple[ModuleType, ...] = (
    scene,
    support,
    things,
    routes,
    land,
    contact,
    story,
    claims,
    described,
    shots,
    review,
    delivery,
    categories,
    rigid,
    cloth,
    liquid,
    elastic,
    fracture,
    particles,
    gas,
)
"""Modules with a table `QUESTIONS`, in the order of `docs/rows.md`."""

QUESTIONS: Mapping[str, Question] = MappingProxyType({q.id: q for table in TABLES for q in table.QUESTIONS})
"""Every question by its id."""
