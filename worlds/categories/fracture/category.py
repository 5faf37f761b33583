"""Breakable bodies: rigid bodies whose contract says how they break."""

from ..category import CategorySpec

__all__ = ["FRACTURE"]

FRACTURE = CategorySpec(name="fracture", shape="solid")
