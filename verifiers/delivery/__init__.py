"""Completeness, bundles, and what binds a verdict to its cache."""
