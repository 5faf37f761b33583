"""What is special to one category of matter in the checks."""
