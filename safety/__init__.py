"""The safety gate as a library: what keeps a base of any make from falling and from hitting."""
