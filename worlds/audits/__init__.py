"""Audits of a specification before anything is built."""
