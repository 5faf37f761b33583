"""Liquids against laws, exact solutions and experiments: one list of cases for both engines, each at two resolutions.

`python -m worldagent.tests.physics.liquid_cases` prints the table; tests assert the gates.
"""
