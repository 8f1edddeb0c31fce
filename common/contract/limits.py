"""How large a message and each number in it may be: whatever is larger is refused before work is spent on it.

The bus looks at a payload's length by its key, msgpack at what is not `bin`, and the messages at each field. Every
limit leaves room for any real robot; none leaves room for an overflow, a division by zero or a shortage of memory.
"""

import math

from pydantic import Field

MOST_SIDE = 4096  # [px] of a depth image
MOST_PIXELS = 2**21  # of a depth image, as 1920 x 1080: as many as are unpacked within the 33 ms of a frame
MOST_CELLS = 2**24  # of a map
MOST_BEAMS = 20_000  # of a scan
MOST_BEAM_FIELDS = 8  # of a scan, those of newer programs included, which a reader does not know
MOST_SAMPLES = 1024  # of a gyro, in one message

SMALL = 32 * 1024  # [bytes] of a message or a request, and of all that is not `bin` in a larger one
PAYLOAD = {  # [bytes] of the messages that may be larger
    "DepthImage": 2 * MOST_PIXELS + 2 * 2**16 + SMALL,  # what cannot be compressed, and every level
    "LaserScan": MOST_BEAM_FIELDS * 4 * MOST_BEAMS + SMALL,
    "OccupancyGrid": MOST_CELLS + SMALL,
}
LARGEST = max(PAYLOAD.values())

NEAREST_REACH, FARTHEST_REACH = 0.001, 1000.0  # [m] of a depth camera
DEEPEST = 65.535  # [m] that 16 bits of millimetres hold
LEAST_NOISE, MOST_NOISE = 1e-5, 0.1  # [1/m] of inverse depth
WIDEST_BASELINE = 1.0  # [m] between a sensor's two eyes
LOWEST_CAMERA, HIGHEST_CAMERA = 0.001, 20.0  # [m] above the floor
FARTHEST_PLACE = 5.0  # [m] of a camera on the base, to either side
LONGEST_PERIOD = 1e4  # [s] between two frames
FINEST_INCREMENT = 1e-6  # [rad] between two beams
LONGEST_NAME = 256  # characters
LONGEST_TEXT = 1000  # characters

NAME = Field(max_length=LONGEST_NAME)
TEXT = Field(max_length=LONGEST_TEXT)  # for people
COUNTERS = Field(max_length=256)  # different ones, of a service
COUNT = Field(ge=0, lt=2**16)  # as a sensor reports it
COORDINATE = Field(ge=-1e8, le=1e8)  # [m], of UTM too
HEADING = Field(ge=-1e6, le=1e6)  # [rad], of a robot that has turned for a long time
SPEED = Field(ge=-1e3, le=1e3)  # [m/s] or [rad/s]
VARIANCE = Field(ge=-1e12, le=1e12)  # or covariance
READING = Field(ge=-1e6, le=1e6)  # of a sensor, in its unit
FREQUENCY = Field(ge=0, le=1e12)  # [Hz]
SECONDS = Field(ge=-1e10, le=1e10)  # any two stamps lie less apart
PERIOD = Field(ge=0, le=LONGEST_PERIOD)  # [s]
AZIMUTH = Field(ge=-4 * math.pi, le=4 * math.pi)  # [rad]
INCREMENT = Field(ge=FINEST_INCREMENT, le=2 * math.pi)  # [rad]
RANGE_MIN = Field(ge=0, le=1e5)  # [m]
RANGE_MAX = Field(ge=1e-6, le=1e5)  # [m]
RESOLUTION = Field(ge=1e-4, le=1e3)  # [m]
