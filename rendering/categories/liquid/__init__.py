"""Liquids in pictures: surfaces, drops, wet solids."""
