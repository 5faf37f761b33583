"""Liquids."""

from ..category import CategorySpec

__all__ = ["LIQUID"]

LIQUID = CategorySpec(name="liquid", shape="loose")
