"""Claims of the prompt, judged in the motion and the pictures."""
