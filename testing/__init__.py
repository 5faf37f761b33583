"""Worlds and seeded defects that tests, benchmarks and `worldagent bench defects` share."""
