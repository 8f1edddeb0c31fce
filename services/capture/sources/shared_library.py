"""Loads a C library of a camera with its functions typed."""

import ctypes
from collections.abc import Mapping, Sequence

Prototypes = Mapping[str, tuple[type | None, tuple[type, ...]]]  # result and arguments by function


def load(names: Sequence[str], prototypes: Prototypes) -> ctypes.CDLL:
    """The first of the libraries that is installed, its functions typed. Raises OSError where none is."""
    for name in names:
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        for function, (result, arguments) in prototypes.items():
            getattr(library, function).restype = result
            getattr(library, function).argtypes = arguments
        return library
    raise OSError(f"no library called {' or '.join(names)}")
