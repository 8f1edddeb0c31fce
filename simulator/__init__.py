"""A robot in a MuJoCo world: its body, its Kobuki and its Kinect, and the exact truth about where the floor ends."""

from cliffscan.common.runtime.kernel_cache import ensure_writable

ensure_writable(__path__)  # before any kernel is imported
