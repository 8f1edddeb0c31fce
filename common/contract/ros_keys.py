"""The keys of a ROS 2 domain on Zenoh, as rmw_zenoh has them: no robot's, and shared by all nodes of the domain."""

TOKENS = "@ros2_lv"  # beginning of the liveliness tokens that say which nodes and endpoints there are
LATCHED = "@adv"  # follows the key of a topic whose last sample is kept (Zenoh's advanced publication)
DOMAIN = 0  # of ROS, unless ROS_DOMAIN_ID says otherwise
LAST_DOMAIN = 232


def domain_keys(domain: int) -> tuple[str, str]:
    """The keys of a domain's topics and services. Zenoh's wild cards match no part that begins with @ but by name."""
    return f"{domain}/**", f"{domain}/**/{LATCHED}/**"


def domain_tokens(domain: int) -> str:
    """The tokens of a domain's nodes and endpoints."""
    return f"{TOKENS}/{domain}/**"
