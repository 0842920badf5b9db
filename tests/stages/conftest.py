"""What tests of stages share as fixtures."""

import pytest

from melt._compile import Kernel


@pytest.fixture
def emulated(monkeypatch):
    """Run CUDA kernels on the host."""
    monkeypatch.setattr(Kernel, "emulated", True)
