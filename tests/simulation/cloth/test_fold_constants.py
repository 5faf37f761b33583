"""The two routes through a cloth's contacts, for CPUs and for GPUs, push alike."""

from __future__ import annotations

from worldagent.simulation.cloth import contact_kernels, fold_kernels


def test_both_routes_push_as_hard_and_as_fast() -> None:
    """Compiled kernels of folds are kept by the text of their own module, so that the numbers stand there once more."""
    assert float(contact_kernels.PUSH.value) == fold_kernels.PUSH
    assert float(contact_kernels.FASTEST.value) == fold_kernels.FASTEST
