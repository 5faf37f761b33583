"""Bounds of what a bundle's verdict may differ from an own one."""

NOISE = 1e-9
"""[1] Relative difference of one number judged twice from equal bytes: threads of BLAS may sum in another order."""
OTHER_MACHINE = 1e-3
"""[1] Own choice: relative difference of one number judged from a motion that another machine class or version simulated (S14).
Contact amplifies rounding, so that a chaotic world may differ by more; its bundle then does not verify there."""
