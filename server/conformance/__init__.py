"""Fixtures of the official conformance suite, served by `worldagent serve --conformance` beside the real tools.

Nothing is imported here: worker processes run the entries in `jobs` and need no protocol for that.
"""
