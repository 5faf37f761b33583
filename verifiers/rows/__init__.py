"""Rows of the requirements matrix: questions, findings, corrections, and the one place where a row is made."""
