"""Rows about things of a household and of buildings: what opens, how large its kind is, how well its shapes agree."""
