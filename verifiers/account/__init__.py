"""The account of a candidate: a text on its events, from caches and geometry, without a name or a text of whoever made it."""
