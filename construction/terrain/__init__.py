"""Floor 3: landscapes. Height, erosion, water, ground materials and vegetation, each a set of named fields on one grid."""
