"""Cloth: triangles with real stiffness, stepped explicitly, with contact that lets nothing through."""
