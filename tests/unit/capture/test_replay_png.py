"""A PNG is read as it is or it is a bad frame: however it was broken, nothing else happens, nothing false is read."""

import contextlib
import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from PIL.PngImagePlugin import PngImageFile

from cliffscan.services.capture.sources.depth_folder import DepthFolder, read_depth
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.replay import Replay
from tests import scenes
from tests.build import depth_folder

VIEW = scenes.camera()
DEPTH = scenes.depth(VIEW, [scenes.HOLE])


def written(pixels):
    """The bytes of a PNG that Pillow writes."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, format="PNG")
    return file.getvalue()


GOOD = written(DEPTH)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Where each test puts its frame."""
    return tmp_path_factory.mktemp("png") / "frame.png"


def assert_right_or_bad(path, data):
    path.write_bytes(data)
    with contextlib.suppress(BadFrame):
        np.testing.assert_array_equal(read_depth(path, VIEW.width, VIEW.height), DEPTH)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


SIGNATURE, END = b"\x89PNG\r\n\x1a\n", chunk(b"IEND", b"")


def header(width, height):
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))


def png(width, height, pixels, *extra):
    rows = b"".join(b"\x00" + row.astype(">u2").tobytes() for row in pixels)
    return SIGNATURE + header(width, height) + b"".join(extra) + chunk(b"IDAT", zlib.compress(rows)) + END


@pytest.mark.parametrize("value", [0, 1, 255, 256, 32767, 32768, 65535])
def test_every_value_is_read_as_it_was_written(path, value):
    path.write_bytes(png(5, 3, np.full((3, 5), value, np.uint16)))
    read = read_depth(path, 5, 3)
    assert (read == value).all()
    assert (read.shape, read.dtype) == ((3, 5), np.uint16)


def test_what_pillow_wrote_is_read(path):
    path.write_bytes(GOOD)
    np.testing.assert_array_equal(read_depth(path, VIEW.width, VIEW.height), DEPTH)


def test_a_png_cut_short_anywhere_is_bad_or_whole(path):
    for length in range(len(GOOD)):
        assert_right_or_bad(path, GOOD[:length])


def test_a_png_cut_short_in_its_middle_is_bad(path):
    path.write_bytes(GOOD[: len(GOOD) // 2])
    with pytest.raises(BadFrame, match=r"frame\.png: "):
        read_depth(path, VIEW.width, VIEW.height)


def test_a_png_with_any_bit_flipped_is_bad_or_whole(path):
    for place in range(len(GOOD)):
        broken = bytearray(GOOD)
        broken[place] ^= 1 << place % 8
        assert_right_or_bad(path, bytes(broken))


@given(data=st.data())
def test_a_png_with_any_bytes_changed_is_bad_or_whole(path, data):
    broken = bytearray(GOOD)
    for place in data.draw(st.lists(st.integers(8, len(GOOD) - 1), min_size=1, max_size=4)):
        broken[place] = data.draw(st.integers(0, 255))
    assert_right_or_bad(path, bytes(broken))


@pytest.mark.parametrize("data", [b"", b"\x89PNG\r\n\x1a\n", b"P5 4 3 65535\n" + bytes(24), b"GIF89a", bytes(1000)])
def test_what_is_no_png_is_bad(path, data):
    path.write_bytes(data)
    with pytest.raises(BadFrame, match=r"frame\.png: "):
        read_depth(path, 4, 3)


@pytest.mark.parametrize("size", [(3, 4), (4, 4), (640, 480), (1, 1)])
def test_another_size_is_bad_and_both_are_named(path, size):
    path.write_bytes(png(4, 3, np.zeros((3, 4), np.uint16)))
    with pytest.raises(BadFrame, match=f"4x3 I;16, expected {size[0]}x{size[1]} 16-bit grey"):
        read_depth(path, *size)


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "LA", "1", "P"])
def test_another_kind_of_picture_is_bad_and_named(path, mode):
    Image.new(mode, (4, 3)).save(path)
    with pytest.raises(BadFrame, match=f"4x3 {mode}, expected 4x3 16-bit grey"):
        read_depth(path, 4, 3)


def test_another_format_of_the_right_kind_is_bad(path):
    Image.fromarray(np.zeros((3, 4), np.uint16)).save(path, format="TIFF")
    with pytest.raises(BadFrame, match="cannot identify"):
        read_depth(path, 4, 3)


@pytest.mark.parametrize("side", [10_000, 20_000, 2**31 - 1])
@pytest.mark.filterwarnings("ignore::PIL.Image.DecompressionBombWarning")
def test_a_png_that_claims_to_be_huge_is_bad(path, side):
    path.write_bytes(png(side, side, []))
    with pytest.raises(BadFrame, match=r"frame\.png: "):
        read_depth(path, 4, 3)


CHUNKS = [b"gAMA", b"cHRM", b"pHYs", b"sRGB", b"iCCP", b"tRNS", b"zTXt", b"iTXt", b"acTL", b"fcTL", b"fdAT", b"eXIf"]


@pytest.mark.filterwarnings("ignore:Invalid APNG")
@pytest.mark.parametrize("content", [b"", b"1", bytes(9)], ids=len)
@pytest.mark.parametrize("kind", CHUNKS)
def test_a_strange_chunk_is_bad_or_does_no_harm(path, kind, content):
    path.write_bytes(png(4, 3, np.full((3, 4), 7, np.uint16), chunk(kind, content)))
    with contextlib.suppress(BadFrame):
        assert (read_depth(path, 4, 3) == 7).all()


@pytest.mark.parametrize("chunks", [b"", header(4, 3), header(4, 3) + chunk(b"sRGB", b"")], ids=len)
def test_a_png_without_pixels_is_bad(path, chunks):
    path.write_bytes(SIGNATURE + chunks + END)
    with pytest.raises(BadFrame, match=r"frame\.png: "):
        read_depth(path, 4, 3)


@pytest.mark.parametrize("fault", [IndexError, KeyError, TypeError, zlib.error, struct.error, MemoryError])
def test_whatever_pillow_raises_costs_one_frame(path, monkeypatch, fault):
    def verify(_):
        raise fault("of bad bytes")

    monkeypatch.setattr(PngImageFile, "verify", verify)
    path.write_bytes(GOOD)
    with pytest.raises(BadFrame, match=r"frame\.png: "):
        read_depth(path, VIEW.width, VIEW.height)


def test_a_file_that_goes_away_or_is_none_is_bad(tmp_path):
    folder = depth_folder(tmp_path, count=2)
    (folder / "000a.png").mkdir()
    source = Replay(DepthFolder(folder), 1000, loop=False)
    (folder / "001.png").unlink()
    assert source.read(1.0)
    for name in ("000a", "001"):
        with pytest.raises(BadFrame, match=name):
            source.read(1.0)
