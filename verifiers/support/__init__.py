"""What holds everything up."""
