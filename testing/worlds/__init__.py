"""Small worlds, and how they are simulated or forged."""
