"""The report about a run: plain data, and one page."""
