"""The web page of a workspace: what a person sees who watches an agent at work."""

from .routes import page_routes

__all__ = ["page_routes"]
