"""Gas in pictures: smoke, steam, dust and the glow of what is hot."""
