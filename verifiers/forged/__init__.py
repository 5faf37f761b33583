"""Forged motions: of each kind of event one in which it plainly happens, so that what must never happen could."""
