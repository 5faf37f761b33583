"""Free-surface liquids: particle and grid engines behind one interface (R57-R59, R66-R68)."""
