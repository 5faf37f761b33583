"""Rows from what somebody who did not make the world answered about its prompt."""
