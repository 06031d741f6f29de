"""What every source of stereo pairs is like."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from stereo_pick.core.arrays import Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.images import FULL_SCALE_16, ImageBuffer, pixels
from stereo_pick.core.pairing import Side


@dataclass(frozen=True, eq=False)
class SourcePair:
    """A raw pair. stamp_ns: when the left image was taken; recorded_ns: when the pair was complete [ns].

    left_frame_id, right_frame_id: the frames that were recorded with the images; empty where none were.
    full_scale_16: the value of a 16-bit image that is white.
    """

    left: ImageBuffer
    right: ImageBuffer
    stamp_ns: int
    recorded_ns: int
    left_frame_id: str = ""
    right_frame_id: str = ""
    full_scale_16: int = FULL_SCALE_16

    def images(self) -> tuple[Image, Image]:
        """Left and right decoded, 8 bit, grey (H, W) or BGR (H, W, 3); raises ImageError naming the side."""
        left = pixels(self.left, self.full_scale_16, "left image")
        return left, pixels(self.right, self.full_scale_16, "right image")


class StereoSource(Protocol):
    """Stereo pairs in the order of their stamps; iterating again starts over."""

    @property
    def count(self) -> int | None:
        """How many pairs there are, if every image has its partner; None where nobody knows."""

    @property
    def paths(self) -> tuple[Path, ...]:
        """The files that are read, or the folder of which every file belongs to the recording."""

    @property
    def names(self) -> Mapping[Side, str]:
        """What to call the images of each side in messages."""

    @property
    def has_stamps(self) -> bool:
        """Whether the stamps say when the images were taken, and do not merely count from 0."""

    @property
    def cameras(self) -> tuple[Camera, Camera] | None:
        """Left and right calibration that came with the images; None where none did.

        Raises CalibrationError, naming where it stands, on one that no real camera has.
        """

    def __iter__(self) -> Iterator[SourcePair]:
        """Yield one pair after the other; raises SourceError or ImageError where no further one can be read."""


def without_partner(source: StereoSource, pairs: int) -> str:
    """What to say of images without partner, after the whole source gave so many pairs; empty where all are paired."""
    count = source.count or 0
    if pairs >= count:
        return ""
    return (
        f"{count - pairs} of {count} pairs lack an image: it was not recorded, or its stamp is farther from its "
        "partner's than max_stamp_offset_s"
    )
