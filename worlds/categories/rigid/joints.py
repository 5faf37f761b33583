"""Joints between rigid bodies (R27)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...vocabulary import EntityRef, Finite, NonNegative, Positive, SpecModel, Vec3

__all__ = ["BallJoint", "HingeJoint", "SlideJoint", "SpringJoint", "WeldJoint"]


class _Joint(SpecModel):
    parent: EntityRef | None = Field(default=None, description="default: the world")
    child: EntityRef
    anchor: Vec3 = Field(description="world coordinates at frame 0 [m], on or in both bodies (a hinge: some point of its axis)")
    damping: NonNegative = Field(default=0.0, description="[N m s/rad] or [N s/m]")
    stiffness: NonNegative = Field(default=0.0, description="spring towards the initial position [N m/rad] or [N/m]")
    collide: bool = Field(default=False, description="whether parent and child collide with each other")


class HingeJoint(_Joint):
    """One rotation about `axis` through `anchor`."""

    kind: Literal["hinge"] = "hinge"
    axis: Vec3
    range: tuple[Finite, Finite] | None = Field(default=None, description="[rad]")
    friction: NonNegative = Field(default=0.0, description="dry friction torque [N m]")


class SlideJoint(_Joint):
    """One translation along `axis`."""

    kind: Literal["slide"] = "slide"
    axis: Vec3
    range: tuple[Finite, Finite] | None = Field(default=None, description="[m]")
    friction: NonNegative = Field(default=0.0, description="dry friction force [N]")


class BallJoint(_Joint):
    """Three rotations about `anchor`."""

    kind: Literal["ball"] = "ball"


class WeldJoint(_Joint):
    """No relative motion, until a `detach` driver opens it."""

    kind: Literal["weld"] = "weld"


class SpringJoint(SpecModel):
    """Linear spring between a point of the child and a point of the parent; with `rope`, it only pulls."""

    kind: Literal["spring"] = "spring"
    parent: EntityRef | None = None
    child: EntityRef
    parent_point: Vec3 = Field(description="world coordinates at frame 0 [m], on or in the parent")
    child_point: Vec3 = Field(description="world coordinates at frame 0 [m], on or in the child")
    stiffness: Positive = Field(description="[N/m]")
    damping: NonNegative = Field(default=0.0, description="[N s/m]")
    rest_length: NonNegative | None = Field(default=None, description="[m]; default the initial distance")
    rope: bool = False
