"""FLIP and APIC on a sparse staggered grid: the liquid engine for large extents (R57-R59)."""
