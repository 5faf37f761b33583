"""People's judgement of films, blind: the paper's user study on a local page, and pairs of films beside it."""
