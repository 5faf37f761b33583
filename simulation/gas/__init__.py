"""Gas on a grid: smoke, steam and hot air."""
