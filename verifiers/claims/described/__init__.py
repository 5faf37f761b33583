"""Words of claims that describe, judged on what is built, moves and shows."""
