"""Floor 5: the judge. Candidate to requirement rows; shares no code with what it judges."""
