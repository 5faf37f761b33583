"""A kernel to prove that Warp compiles and runs here (Warp reads kernels from source files)."""

import warp as wp

__all__ = ["double"]

wp.set_module_options({"enable_backward": False})


@wp.kernel  # type: ignore[untyped-decorator]
def double(values: wp.array(dtype=float)):  # type: ignore[valid-type,no-untyped-def]
    """Double each value."""
    i = wp.tid()
    values[i] = 2.0 * values[i]
