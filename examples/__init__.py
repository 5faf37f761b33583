"""Scripted agents, each a whole world from prompt to acceptance."""
