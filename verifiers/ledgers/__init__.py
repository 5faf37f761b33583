"""Momentum, energy and their sources, from poses and records; numerical health."""
