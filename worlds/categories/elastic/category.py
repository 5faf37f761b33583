"""Elastic bodies."""

from ..category import CategorySpec

__all__ = ["ELASTIC"]

ELASTIC = CategorySpec(name="elastic", shape="deforming")
