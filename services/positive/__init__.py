"""positive: what stands on the floor, by the projection method."""

from cliffscan.common.runtime.kernel_cache import ensure_writable

ensure_writable(__path__)  # before any kernel is imported
