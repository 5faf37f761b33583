"""Gas in specifications."""
