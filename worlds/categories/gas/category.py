"""Gas: declared in the specification, moved by no engine."""

from ..category import CategorySpec

__all__ = ["GAS"]

GAS = CategorySpec(name="gas", shape="loose")
