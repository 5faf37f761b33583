"""Cloth."""

from ..category import CategorySpec

__all__ = ["CLOTH"]

CLOTH = CategorySpec(name="cloth", shape="deforming")
