"""Benchmarks: each module has `run()`, which returns the figures; `worldagent bench NAME` joins them with the machine."""
