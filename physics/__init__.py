"""Published laws of physics that solver and judge both need: pure functions of numbers and arrays, with their sources."""
