"""Reviews: what a reader who did not make the world is asked, by whom it is answered, and where the answers are kept."""
