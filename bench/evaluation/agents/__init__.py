"""Agents of the harness, as solvers of Inspect."""
