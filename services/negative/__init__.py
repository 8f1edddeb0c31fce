"""negative: where the floor ends, by each of the paper's methods and by all of them combined."""

from cliffscan.common.runtime.kernel_cache import ensure_writable

ensure_writable(__path__)  # before any kernel is imported
