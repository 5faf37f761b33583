"""Beats, causes, counterfactuals, robustness, phases."""
