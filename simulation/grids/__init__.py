"""Engines on grids share: arrays and passes of one device, columns of cells, the multigrid solver of pressure."""
