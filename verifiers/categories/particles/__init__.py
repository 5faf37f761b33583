"""Checks of grains and flying particles."""
