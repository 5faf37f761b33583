"""The matrix report: one HTML page with its pictures."""
