"""The memory of one frame serves the next, instead of going back to the system and coming again page by page.

A frame takes some 4 MB of arrays. glibc gives them back when they are freed, and each of their thousand pages then
costs a fault at the next frame: a fifth of the processor time of `perception`.
"""

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # of glibc's malloc.h
KEPT = 32 * 2**20  # bytes that may be free at the end of the heap
IN_HEAP = 8 * 2**20  # bytes of one array that lies in the heap; a larger one is mapped, and given back, by itself


def keep_freed_memory() -> None:
    """Have the C library keep what is freed; another one than glibc decides by itself."""
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt:
        mallopt(M_MMAP_THRESHOLD, IN_HEAP)
        mallopt(M_TRIM_THRESHOLD, KEPT)
