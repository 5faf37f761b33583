"""Bounds of the check `terrain`."""

LEVEL_M = 1e-4
"""[m] Levels agree within this: fields other than height are kept in float32."""
LEDGER = 1e-6
"""[1] Largest relative error of the mass balance (R46 and the gate of the erosion studies)."""
PATCH_M = 1e-3
"""[m] A ground cut from a landscape keeps its heights within this at its own corners: float32 at 10 km is 1 mm."""
SEAM = 1e-4
"""[m] Own choice: a gap between grounds that no particle of a liquid gets through."""
