"""The ROS 2 messages and services that are used, with the type hashes by which nodes recognise them."""

from typing import NamedTuple


class Interface(NamedTuple):
    """A type and its hash (REP-2016), which is the same in Jazzy and later."""

    package: str
    name: str
    digest: str  # SHA-256 of the definition, hexadecimal
    kind: str = "msg"  # or srv

    @property
    def message_name(self) -> str:
        """The type's name for people and files, as sensor_msgs/msg/LaserScan."""
        return f"{self.package}/{self.kind}/{self.name}"

    @property
    def dds_name(self) -> str:
        """The type's name on the wire."""
        return f"{self.package}::{self.kind}::dds_::{self.name}_"

    @property
    def type_hash(self) -> str:
        """The hash as keys have it."""
        return f"RIHS01_{self.digest}"


LASER_SCAN = Interface("sensor_msgs", "LaserScan", "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828")
POINT_CLOUD = Interface(
    "sensor_msgs", "PointCloud2", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"
)
IMAGE = Interface("sensor_msgs", "Image", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47")
CAMERA_INFO = Interface("sensor_msgs", "CameraInfo", "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275")
COMPRESSED_IMAGE = Interface(
    "sensor_msgs", "CompressedImage", "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"
)
IMU = Interface("sensor_msgs", "Imu", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b")
BATTERY_STATE = Interface(
    "sensor_msgs", "BatteryState", "4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741"
)
ODOMETRY = Interface("nav_msgs", "Odometry", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0")
OCCUPANCY_GRID = Interface(
    "nav_msgs", "OccupancyGrid", "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"
)
TWIST = Interface("geometry_msgs", "Twist", "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a")
TWIST_STAMPED = Interface(
    "geometry_msgs", "TwistStamped", "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"
)
TF_MESSAGE = Interface("tf2_msgs", "TFMessage", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087")
DIAGNOSTIC_ARRAY = Interface(
    "diagnostic_msgs", "DiagnosticArray", "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
)
STRING = Interface("std_msgs", "String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18")
TRIGGER = Interface("std_srvs", "Trigger", "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f", "srv")

# every row above
INTERFACES: tuple[Interface, ...] = tuple(row for row in list(vars().values()) if isinstance(row, Interface))
