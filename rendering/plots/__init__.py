"""Plots over time: records of the solvers and accounts of energy and momentum."""
