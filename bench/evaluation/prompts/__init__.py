"""Prompts of the benchmark as data, and their reader."""
