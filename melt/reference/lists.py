"""Lists of slots: bubbles, free slots, candidates. Boiling spec 3. The page names flag, list and count."""

import numpy as np


def list_slots(flag, key, index, count, chunk_sum):
    """Write the slots with flag == key, ascending, and how many they are.

    Reads: flag (n,). Writes: index (n,), of which the first count[0] count; count (1,).
    """
    on = np.flatnonzero(flag == key)
    index[: on.size] = on
    count[0] = on.size


def order_by_id(id, count, index, list_scratch):
    """Sort the first count[0] entries of a list by the id of the particles; the others stay.

    Reads: id (n,), count (1,). Writes: index (n,).
    """
    on = index[: int(count[0])]
    index[: on.size] = on[np.argsort(id[on], kind="stable")]
