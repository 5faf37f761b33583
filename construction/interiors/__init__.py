"""Rooms: plans, walls with openings, and what stands in them."""
