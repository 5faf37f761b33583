"""Check of the shot plan: where cameras are and what they see."""
