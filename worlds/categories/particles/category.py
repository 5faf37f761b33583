"""Grains and flying particles."""

from ..category import CategorySpec

__all__ = ["PARTICLES"]

PARTICLES = CategorySpec(name="particles", shape="loose")
