"""Overlap, tunnelling and the contact log, frame by frame."""
