from __future__ import annotations

from array import array
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.errors import ImageError, ParameterError
from stereo_pick.core.images import ImageBuffer, decode_compressed, encode, pixels, read_image

GREY = np.random.default_rng(0).integers(0, 256, (7, 9), np.uint8)
BGR = np.random.default_rng(1).integers(0, 256, (7, 9, 3), np.uint8)
ALPHA = np.random.default_rng(2).integers(0, 256, (7, 9, 1), np.uint8)

STORED = {
    "mono8": (GREY, GREY),
    "8UC1": (GREY, GREY),
    "mono16": (GREY.astype("<u2") * 257, GREY),
    "16UC1": (GREY.astype("<u2") * 257, GREY),
    "bgr8": (BGR, BGR),
    "8UC3": (BGR, BGR),
    "rgb8": (BGR[..., ::-1], BGR),
    "bgra8": (np.dstack([BGR, ALPHA]), BGR),
    "rgba8": (np.dstack([BGR[..., ::-1], ALPHA]), BGR),
    "yuv422": (np.dstack([ALPHA, GREY]), GREY),
    "uyvy": (np.dstack([ALPHA, GREY]), GREY),
    "yuv422_yuy2": (np.dstack([GREY, ALPHA]), GREY),
    "yuyv": (np.dstack([GREY, ALPHA]), GREY),
}


def packed(stored: np.ndarray, encoding: str, padding: int = 0, is_bigendian: bool = False) -> ImageBuffer:
    """A buffer whose rows end in `padding` bytes of rubbish."""
    height, width = stored.shape[:2]
    rows = np.frombuffer(stored.tobytes(), np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=171)
    return ImageBuffer(width, height, rows.shape[1], encoding, is_bigendian, rows.tobytes())


@pytest.mark.parametrize("padding", [0, 1, 7])
@pytest.mark.parametrize("encoding", STORED)
def test_every_encoding_gives_back_the_picture(encoding: str, padding: int) -> None:
    stored, picture = STORED[encoding]
    decoded = pixels(packed(stored, encoding, padding))
    assert decoded.dtype == np.uint8
    assert decoded.shape == picture.shape
    assert (decoded == picture).all()
    assert not decoded.flags.writeable


@pytest.mark.parametrize("encoding", ["mono16", "16UC1"])
def test_both_byte_orders_give_the_same_picture(encoding: str) -> None:
    stored = np.random.default_rng(3).integers(0, 65536, (5, 6)).astype("<u2")
    little = pixels(packed(stored, encoding, padding=1))
    big = pixels(packed(stored.astype(">u2"), encoding, padding=3, is_bigendian=True))
    assert (little == big).all()


@given(st.integers(1, 65535), st.integers(0, 65535))
def test_sixteen_bits_are_scaled_by_the_full_scale(full_scale: int, value: int) -> None:
    decoded = pixels(packed(np.array([[value]], "<u2"), "mono16"), full_scale)
    assert abs(int(decoded[0, 0]) - min(255.0, value * 255 / full_scale)) <= 0.501


@pytest.mark.parametrize("full_scale", [0, -1, 65536])
def test_an_impossible_full_scale_is_refused(full_scale: int) -> None:
    with pytest.raises(ParameterError, match=f"full_scale_16 = {full_scale}.*1 .. 65535"):
        pixels(packed(GREY.astype("<u2"), "mono16"), full_scale)


@pytest.mark.parametrize("picture", [GREY, BGR, BGR[::2, ::2], GREY.T])
def test_decoding_what_was_encoded_changes_nothing(picture: np.ndarray) -> None:
    buffer = encode(picture)
    assert buffer.encoding == ("mono8" if picture.ndim == 2 else "bgr8")
    assert (pixels(buffer) == picture).all()


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview, lambda data: array("B", data), np.array])
def test_any_kind_of_bytes_is_read_and_its_message_is_the_same(kind: object) -> None:
    data = kind(GREY.ravel()) if kind is np.array else kind(GREY.tobytes())  # type: ignore[operator]
    buffer = ImageBuffer(9, 7, 9, "mono8", False, data)
    assert (pixels(buffer) == GREY).all()
    assert bytes(buffer.data) == GREY.tobytes()


@pytest.mark.parametrize("encoding", ["mono8", "8UC1", "bgr8", "8UC3"])
def test_decoding_does_not_copy_what_needs_no_conversion(encoding: str) -> None:
    buffer = packed(STORED[encoding][0], encoding, padding=4)
    assert np.shares_memory(pixels(buffer), np.frombuffer(buffer.data, np.uint8))


def test_data_behind_the_last_row_is_ignored() -> None:
    buffer = encode(GREY)
    longer = ImageBuffer(9, 7, 9, "mono8", False, bytes(buffer.data) + b"rubbish")
    assert (pixels(longer) == GREY).all()


@pytest.mark.parametrize(
    ("buffer", "parts"),
    [
        (ImageBuffer(9, 7, 9, "nv21", False, bytes(63)), ["'nv21'", *STORED]),
        (ImageBuffer(9, 7, 9, "", False, bytes(63)), ["''", *STORED]),
        (ImageBuffer(9, 7, 9, "bayer_rggb8", False, bytes(63)), ["'bayer_rggb8'", "debayer", "upstream"]),
        (ImageBuffer(0, 7, 0, "mono8", False, b""), ["0 x 7", "positive"]),
        (ImageBuffer(9, 0, 9, "mono8", False, b""), ["9 x 0", "positive"]),
        (ImageBuffer(9, 7, 9, "bgr8", False, bytes(63)), ["step = 9", "9 bgr8 pixels", "27 bytes"]),
        (ImageBuffer(9, 7, 17, "mono16", False, bytes(200)), ["step = 17", "18 bytes"]),
        (ImageBuffer(9, 7, 9, "mono8", False, bytes(62)), ["data holds 62 bytes, but step x height = 63"]),
        (ImageBuffer(9, 7, 9, "mono8", False, b""), ["data holds 0 bytes, but step x height = 63"]),
    ],
)
def test_a_buffer_that_is_no_picture_is_named(buffer: ImageBuffer, parts: list[str]) -> None:
    with pytest.raises(ImageError) as error:
        pixels(buffer, what="left image")
    for part in ["left image", *parts]:
        assert part in str(error.value)


def compressed(picture: np.ndarray, suffix: str) -> bytes:
    return bytes(cv2.imencode(suffix, picture)[1])


@pytest.mark.parametrize("suffix", [".png", ".bmp", ".tif"])
@pytest.mark.parametrize("picture", [GREY, BGR])
def test_lossless_files_give_back_the_picture(suffix: str, picture: np.ndarray) -> None:
    decoded = decode_compressed(compressed(picture, suffix), "left image")
    assert decoded.shape == picture.shape or suffix == ".bmp"
    assert (decoded == (picture if decoded.ndim == picture.ndim else picture[..., None])).all()


def test_a_jpeg_is_nearly_the_picture() -> None:
    smooth = cv2.GaussianBlur(cv2.resize(BGR, (64, 48)), (0, 0), 4)
    decoded = decode_compressed(compressed(smooth, ".jpg"), "left image")
    assert np.abs(decoded.astype(int) - smooth).mean() < 3


def test_sixteen_bit_files_are_scaled_and_alpha_is_dropped() -> None:
    assert (decode_compressed(compressed(GREY.astype(np.uint16) * 257, ".png"), "image") == GREY).all()
    assert (decode_compressed(compressed(np.dstack([BGR, ALPHA]), ".png"), "image") == BGR).all()
    deep = np.dstack([BGR, ALPHA]).astype(np.uint16) * 257
    assert (decode_compressed(compressed(deep, ".png"), "image") == BGR).all()


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".bmp", ".pgm", ".tif"])
def test_a_file_that_is_cut_short_is_refused_at_any_length(suffix: str) -> None:
    whole = compressed(np.tile(GREY, (8, 8)), suffix)
    for length in range(0, len(whole) - 16, 97):
        with pytest.raises(ImageError, match="left image"):
            decode_compressed(whole[:length], "left image")


def test_a_jpeg_that_the_camera_padded_is_read() -> None:
    whole = compressed(BGR, ".jpg")
    assert (decode_compressed(whole + bytes(100), "image") == decode_compressed(whole, "image")).all()


@pytest.mark.parametrize("data", [b"", b"no image at all", bytes(1000)])
def test_what_is_no_image_is_named(data: bytes) -> None:
    with pytest.raises(ImageError, match=f"left image .*{len(data)} bytes"):
        decode_compressed(data, "left image")


def test_floats_are_no_picture() -> None:
    with pytest.raises(ImageError, match=r"depth\.tif holds float32"):
        decode_compressed(compressed(GREY.astype(np.float32), ".tif"), "depth.tif")


def test_a_file_is_read_and_named_where_it_cannot_be(tmp_path: Path) -> None:
    path = tmp_path / "left.png"
    with pytest.raises(ImageError, match=r"left\.png: no such image file"):
        read_image(path)
    with pytest.raises(ImageError, match="cannot be read"):
        read_image(tmp_path)
    path.write_bytes(compressed(BGR, ".png")[:-30])
    with pytest.raises(ImageError, match=r"left\.png is no image, damaged or cut short"):
        read_image(path)
    path.write_bytes(compressed(BGR, ".png"))
    assert (read_image(path) == BGR).all()
