"""Evaluators of predicates. Nothing is imported here: modules of categories import the modules of this folder, and its table imports them."""
