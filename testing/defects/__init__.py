"""Seeded defects: broken worlds that each check must find, and suspicious ones that it must let pass."""

from .cases import Mechanism, Suite, World
from .judge import judge_one
from .suites import CHECKS, suite_of

__all__ = ["CHECKS", "Mechanism", "Suite", "World", "judge_one", "suite_of"]
