"""Landscapes in pictures: land, water and plants, path-traced and in previews, and maps of fields."""
