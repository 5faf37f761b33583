"""Rigid bodies."""

from ..category import CategorySpec

__all__ = ["RIGID"]

RIGID = CategorySpec(name="rigid", shape="solid")
