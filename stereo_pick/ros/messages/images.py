"""sensor_msgs/Image."""

from __future__ import annotations

from array import array

from sensor_msgs.msg import Image as ImageMessage

from stereo_pick.core.arrays import Image
from stereo_pick.core.images import ImageBuffer, encode
from stereo_pick.ros.messages.stamps import header


def buffer_of(message: ImageMessage) -> ImageBuffer:
    """The content of an image message; nothing is checked or copied."""
    return ImageBuffer(
        message.width, message.height, message.step, message.encoding, bool(message.is_bigendian), message.data
    )


def buffer_message(buffer: ImageBuffer, stamp_ns: int, frame_id: str) -> ImageMessage:
    """An image message of a buffer, with a stamp [ns]."""
    data = buffer.data if isinstance(buffer.data, array) else array("B", bytes(buffer.data))
    return ImageMessage(
        header=header(stamp_ns, frame_id),
        height=buffer.height_px,
        width=buffer.width_px,
        encoding=buffer.encoding,
        is_bigendian=int(buffer.is_bigendian),
        step=buffer.step_bytes,
        data=data,
    )


def image_message(image: Image, stamp_ns: int, frame_id: str) -> ImageMessage:
    """A mono8 or bgr8 message of an image (H, W) or (H, W, 3), with a stamp [ns]."""
    return buffer_message(encode(image), stamp_ns, frame_id)
