"""Judges of the categories of matter, with their questions, laws and ledgers."""
