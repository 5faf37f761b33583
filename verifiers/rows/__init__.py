"""How a verdict becomes a row: questions, findings, corrections."""
