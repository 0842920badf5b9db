"""Counting of flags on the device in a fixed shape."""

from melt._compile import cuda, cuda_kernel


@cuda_kernel
def count_pieces(flag, pieces):
    """Write how many of each of the pieces of ``flag`` are set."""
    t = cuda.grid(1)
    number = pieces.shape[0]
    if t >= number:
        return
    total = 0
    for s in range(flag.shape[0] * t // number, flag.shape[0] * (t + 1) // number):
        total += flag[s]
    pieces[t] = total
