"""What all messages share: one msgpack map each, encoded and decoded here and nowhere else."""

from typing import Annotated, Any, Self, TypeAlias

import msgpack
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PlainValidator, ValidationError

from cliffscan.common.contract.limits import PAYLOAD, SMALL

REPORTED = 3  # faults of one message that are reported
LONGEST = 200  # characters of each
BIN = b"\xc4\xc5\xc6"  # how msgpack begins a `bin`


class MessageError(ValueError):
    """A sample is malformed; the text names each field and what was expected of it."""


def explain(error: ValidationError) -> str:
    """What is wrong, on one short line: `field: what was expected`."""
    details = error.errors(include_input=False, include_url=False)
    reported = [
        ": ".join(filter(None, (_short(".".join(map(str, each["loc"]))), _short(_reason(each["type"], each["msg"])))))
        for each in details[:REPORTED]
    ]
    return "; ".join(reported) + (f"; and {len(details) - REPORTED} more" if len(details) > REPORTED else "")


def _reason(kind: str, message: str) -> str:
    """What pydantic says, in the words of who wrote the field."""
    return "is not known here" if kind == "extra_forbidden" else message.removeprefix("Value error, ")


def _short(text: str) -> str:
    """The text without line ends and control characters, cut where it is long: it may be anybody's."""
    printable = "".join(each if each.isprintable() else repr(each)[1:-1] for each in text[:LONGEST])
    return printable + ("…" if len(text) > LONGEST else "")


def unpack(payload: bytes, most: int = SMALL) -> dict[str, Any]:
    """The msgpack map in `payload`. Raises MessageError where there is none, or one of more than `most` bytes."""
    check_size(len(payload), most)
    try:
        if len(payload) > SMALL:
            _check_plain(payload)
        fields = msgpack.unpackb(payload)
    except (ValueError, msgpack.UnpackException) as error:
        raise error if isinstance(error, MessageError) else MessageError(f"not msgpack: {error}") from error
    if not isinstance(fields, dict):
        raise MessageError(f"expected a map, got {type(fields).__name__}")
    return fields


def check_size(size: int, most: int) -> None:
    """Raise MessageError where a payload has more bytes than `most`."""
    if size > most:
        raise MessageError(f"{size} bytes, expected {most} at most")


def _check_plain(payload: bytes) -> None:
    """Raise MessageError where lists and the like take much room: each of their bytes may cost fifty of memory."""
    reader = msgpack.Unpacker(max_buffer_size=len(payload))
    reader.feed(payload)
    plain = 0
    for _ in range(2 * reader.read_map_header()):
        start = reader.tell()
        reader.skip()
        if payload[start] not in BIN:
            plain += reader.tell() - start
        if plain > SMALL:
            raise MessageError(f"more than {SMALL} bytes that are no bin")


def _little_endian(dtype: str) -> PlainValidator:
    """Turns msgpack `bin` into a read-only array of `dtype`, without a copy; an array stays as it is."""
    kind = np.dtype(dtype)

    def read(value: object) -> NDArray[Any]:
        if isinstance(value, np.ndarray):
            return np.ascontiguousarray(value, kind)
        if not isinstance(value, bytes):
            raise ValueError(f"expected bin, got {type(value).__name__}")
        if len(value) % kind.itemsize:
            raise ValueError(f"{len(value)} bytes are no whole number of {kind.name}")
        return np.frombuffer(value, kind)

    return PlainValidator(read)


Float32s: TypeAlias = Annotated[NDArray[np.float32], _little_endian("<f4")]
Int8s: TypeAlias = Annotated[NDArray[np.int8], _little_endian("<i1")]
UInt64: TypeAlias = Annotated[int, Field(ge=0, lt=2**64)]
Stamp: TypeAlias = Annotated[int, Field(ge=0, lt=2**63)]  # [ns] since the Unix epoch
ListAsTuple = Field(strict=False)  # for a tuple, since msgpack knows lists only; what it holds stays strict


class Part(BaseModel):
    """A map of fields. They are strict and finite; keys nobody knows are ignored."""

    model_config = ConfigDict(
        strict=True, frozen=True, extra="ignore", allow_inf_nan=False, arbitrary_types_allowed=True
    )


class Message(Part):
    """A sample's payload."""

    @classmethod
    def schema_name(cls) -> str:
        """The schema of the Zenoh encoding, e.g. `cliffscan.LaserScan.v1`."""
        return f"cliffscan.{cls.__name__}.v1"

    @classmethod
    def most_bytes(cls) -> int:
        """How large a payload may be."""
        return PAYLOAD.get(cls.__name__, SMALL)

    def encode(self) -> bytes:
        """The msgpack map; arrays become little-endian `bin`."""
        payload: bytes = msgpack.packb(self.__dict__, default=_packable)
        return payload

    @classmethod
    def decode(cls, payload: bytes) -> Self:
        """The message in `payload`. Raises MessageError naming each field that is missing or wrong."""
        return cls.of(unpack(payload, cls.most_bytes()))

    @classmethod
    def of(cls, fields: dict[str, Any]) -> Self:
        """The message with these fields. Raises MessageError."""
        try:
            return cls.model_validate(fields)
        except ValidationError as error:
            raise MessageError(explain(error)) from error


def _packable(value: NDArray[Any] | Part) -> bytes | dict[str, Any]:
    """What msgpack takes in the place of an array or a part of a message."""
    return value.__dict__ if isinstance(value, Part) else value.tobytes()
