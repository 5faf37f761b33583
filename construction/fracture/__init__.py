"""Pre-fractured bodies: a body's parts cut exactly into pieces, and the faces the pieces share."""

from .build import build_pieces

__all__ = ["build_pieces"]
