"""Reports of runs: one page and one JSON file each, and comparisons of two."""
