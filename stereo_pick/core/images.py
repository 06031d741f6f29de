"""Pictures as they are stored and sent, decoded to 8-bit grey or BGR."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from stereo_pick.core.arrays import Image, frozen
from stereo_pick.core.errors import ImageError, ParameterError

FULL_SCALE_16 = 65535
_BAYER = "bayer_"
_COMPRESSIONS = ("jpeg", "jpg", "png", "tif", "bmp", "webp")
Bytes: TypeAlias = "bytes | bytearray | memoryview | array[int] | NDArray[np.uint8]"


@dataclass(frozen=True)
class _Encoding:
    channels: int
    bytes_per_channel: int = 1
    conversion: int | None = None  # of OpenCV's, to grey or BGR


_ENCODINGS = {
    "mono8": _Encoding(1),
    "8UC1": _Encoding(1),
    "mono16": _Encoding(1, bytes_per_channel=2),
    "16UC1": _Encoding(1, bytes_per_channel=2),
    "bgr8": _Encoding(3),
    "8UC3": _Encoding(3),
    "rgb8": _Encoding(3, conversion=cv2.COLOR_RGB2BGR),
    "bgra8": _Encoding(4, conversion=cv2.COLOR_BGRA2BGR),
    "rgba8": _Encoding(4, conversion=cv2.COLOR_RGBA2BGR),
    "yuv422": _Encoding(2, conversion=cv2.COLOR_YUV2GRAY_UYVY),
    "uyvy": _Encoding(2, conversion=cv2.COLOR_YUV2GRAY_UYVY),
    "yuv422_yuy2": _Encoding(2, conversion=cv2.COLOR_YUV2GRAY_YUY2),
    "yuyv": _Encoding(2, conversion=cv2.COLOR_YUV2GRAY_YUY2),
}


@dataclass(frozen=True, eq=False)
class ImageBuffer:
    """The content of a sensor_msgs/Image, unchecked: `pixels` checks it.

    step_bytes: length of a row, padding included; data: row after row, `bytes(data)` gives a message's data.
    """

    width_px: int
    height_px: int
    step_bytes: int
    encoding: str
    is_bigendian: bool
    data: Bytes


def pixels(buffer: ImageBuffer, full_scale_16: int = FULL_SCALE_16, what: str = "image") -> Image:
    """Decode to a read-only grey (H, W) or BGR (H, W, 3) uint8 image; a view of the data where that is possible.

    full_scale_16: the 16-bit value that becomes 255 (4095 for a 12-bit camera); higher ones become 255 too.
    Raises ImageError, naming `what`, on an unknown encoding, a size of zero, a step shorter than a row
    or data shorter than its rows; ParameterError on a full scale outside 1 .. 65535.
    """
    encoding = _encoding(buffer, what)
    rows = _rows(buffer, encoding, what)
    if encoding.bytes_per_channel == 2:
        deep = rows.view(">u2" if buffer.is_bigendian else "<u2")
        # OpenCV takes no row length that is odd or misaligned for 16 bits.
        return _shallow(np.require(deep, np.uint16, ["C", "A"]), full_scale_16)
    if encoding.channels == 1:
        return frozen(rows)
    colour = rows.reshape(buffer.height_px, buffer.width_px, encoding.channels)
    if encoding.conversion is not None:
        colour = np.asarray(cv2.cvtColor(colour, encoding.conversion), np.uint8)
    return frozen(colour)


def encode(image: Image) -> ImageBuffer:
    """Pack a grey (H, W) image as mono8, a BGR one (H, W, 3) as bgr8, without padding."""
    height, width = image.shape[:2]
    encoding, channels = ("mono8", 1) if image.ndim == 2 else ("bgr8", 3)
    return ImageBuffer(width, height, width * channels, encoding, False, image.tobytes())


def decode_message(data: Bytes, declared: str, what: str, full_scale_16: int = FULL_SCALE_16) -> Image:
    """Decode a sensor_msgs/CompressedImage as `decode_compressed` does.

    declared: its format, as `rgb8; jpeg compressed bgr8`, which begins with the encoding before compression.
    Raises ImageError also where that is the mosaic of a Bayer sensor, still in place, which looks like a grey image;
    where it cannot be decoded and is declared as something else than an image file, that is what is to blame.
    """
    try:
        decoded = decode_compressed(data, what, full_scale_16)
    except ImageError:
        if not declared or any(name in declared for name in _COMPRESSIONS):
            raise
        raise ImageError(
            f"{what} is compressed as {declared!r}, neither as JPEG nor as PNG: record image_raw, or its /compressed"
        ) from None
    if declared.startswith(_BAYER) and decoded.ndim == 2:
        raise _unknown(declared.partition(";")[0], what)
    return decoded


def decode_compressed(data: Bytes, what: str, full_scale_16: int = FULL_SCALE_16) -> Image:
    """Decode a PNG, JPEG or any other file that OpenCV knows to grey (H, W) or BGR (H, W, 3), read-only.

    16-bit images are scaled to 8 bit (full_scale_16 becomes 255), alpha is dropped, Exif rotation is ignored.
    Raises ImageError, naming `what`, on data that is no image, cut short, or neither 8 nor 16 bit deep;
    ParameterError on a full scale outside 1 .. 65535.
    """
    encoded = np.frombuffer(data, np.uint8)
    if len(encoded) == 0:
        raise ImageError(f"{what} is empty (0 bytes): copy or record it again")
    try:
        decoded = cv2.imdecode(encoded, cv2.IMREAD_UNCHANGED)
    except cv2.error:
        decoded = None
    if decoded is None or _is_cut_jpeg(encoded):
        raise ImageError(f"{what} is no image, damaged or cut short ({len(encoded)} bytes): copy or record it again")
    return _eight_bit_bgr(np.asarray(decoded), what, full_scale_16)


def read_image(path: Path, full_scale_16: int = FULL_SCALE_16) -> Image:
    """Read an image file as `decode_compressed` does; raises ImageError naming the path."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise ImageError(f"{path}: no such image file; check the path") from None
    except OSError as error:
        raise ImageError(f"{path} cannot be read: {error.strerror}") from None
    return decode_compressed(data, str(path), full_scale_16)


def _encoding(buffer: ImageBuffer, what: str) -> _Encoding:
    known = _ENCODINGS.get(buffer.encoding)
    if known is None:
        raise _unknown(buffer.encoding, what)
    return known


def _unknown(encoding: str, what: str) -> ImageError:
    remedy = f"let the camera driver send one of: {', '.join(_ENCODINGS)}"
    if encoding.startswith(_BAYER):
        remedy = "debayer it upstream (image_proc's DebayerNode), or let the camera driver send mono8 or bgr8"
    return ImageError(f"{what} has the unknown encoding {encoding!r}: {remedy}")


def _rows(buffer: ImageBuffer, encoding: _Encoding, what: str) -> Image:
    """The rows (H, bytes of a row) without their padding, as a view."""
    width, height, step = buffer.width_px, buffer.height_px, buffer.step_bytes
    if width <= 0 or height <= 0:
        raise ImageError(f"{what} is {width} x {height}: its size must be positive; is the camera running?")
    row_bytes = width * encoding.channels * encoding.bytes_per_channel
    if step < row_bytes:
        raise ImageError(
            f"{what}: step = {step} bytes is shorter than a row of {width} {buffer.encoding} pixels, "
            f"{row_bytes} bytes: correct the driver's step or encoding"
        )
    data = np.frombuffer(buffer.data, np.uint8)
    if len(data) < step * height:
        raise ImageError(
            f"{what}: data holds {len(data)} bytes, but step x height = {step * height}: "
            "the image is cut short; send or record it again"
        )
    return data[: step * height].reshape(height, step)[:, :row_bytes]


def check_full_scale(full_scale_16: int) -> None:
    """Raise ParameterError for what is no value of 16 bits, or 0."""
    if not 0 < full_scale_16 <= FULL_SCALE_16:
        raise ParameterError(f"full_scale_16 = {full_scale_16} is outside its range 1 .. {FULL_SCALE_16}")


def _shallow(deep: NDArray[np.uint16], full_scale: int) -> Image:
    check_full_scale(full_scale)
    return frozen(np.asarray(cv2.convertScaleAbs(deep, alpha=255 / full_scale), np.uint8))


def _eight_bit_bgr(decoded: NDArray[Any], what: str, full_scale_16: int) -> Image:
    if decoded.dtype == np.uint16:
        decoded = _shallow(np.asarray(decoded, np.uint16), full_scale_16)
    if decoded.dtype != np.uint8:
        raise ImageError(f"{what} holds {decoded.dtype} values: save it with 8 or 16 bits a channel")
    if decoded.ndim == 3 and decoded.shape[2] == 4:
        decoded = np.asarray(cv2.cvtColor(decoded, cv2.COLOR_BGRA2BGR))
    return frozen(np.asarray(decoded, np.uint8))


def _is_cut_jpeg(encoded: Image) -> bool:
    """OpenCV before 4.14 fills what a cut JPEG lacks with grey, and says nothing."""
    data = encoded.tobytes()
    return data.startswith(b"\xff\xd8") and data.rfind(b"\xff\xd9") < data.rfind(b"\xff\xda")
