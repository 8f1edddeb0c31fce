"""How a topic's quality of service is spelt in Zenoh."""

import zenoh

from cliffscan.common.contract.topics import Qos

PRIORITY = {
    Qos.BULK: zenoh.Priority.DATA_LOW,
    Qos.REAL_TIME: zenoh.Priority.REAL_TIME,
    Qos.STATUS: zenoh.Priority.DATA,
}


def declare_publisher(session: zenoh.Session, key: str, encoding: zenoh.Encoding, qos: Qos) -> zenoh.Publisher:
    """Declare that samples will be put on a key; one is dropped where a link is full."""
    return session.declare_publisher(
        key,
        encoding=encoding,
        congestion_control=zenoh.CongestionControl.DROP,
        priority=PRIORITY[qos],
        express=qos is Qos.REAL_TIME,
    )
