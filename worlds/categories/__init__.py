"""What the specification says about each category of matter."""
