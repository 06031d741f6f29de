"""A folder of image pairs.

Three ways of naming them are known, and the first that occurs is taken for the whole folder:
`left/001.png`, then `left001.png` (also `case_1/left.png`), then `001_left.png`, each with its right
counterpart. So `labels_left.png` beside `left.png` is no left image.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from stereo_pick.core.arrays import Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.errors import ParameterError, SourceError
from stereo_pick.core.images import FULL_SCALE_16, encode, read_image
from stereo_pick.core.pairing import Side
from stereo_pick.sources.source import SourcePair

_SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm"}
_NOT_A_VIEW = {"label", "labels", "mask", "masks", "depth", "disparity"}
_STYLES = (
    re.compile(r"(?:^|(?<=/))(left|right)(?=/)", re.IGNORECASE),
    re.compile(r"(?:^|(?<=/))(left|right)(?![a-z])(?=[^/]*$)", re.IGNORECASE),
    re.compile(r"(?<=[_-])(left|right)$", re.IGNORECASE),
)
_SIDE_IN_STEM = re.compile(r"(?<![a-z])(left|right)(?![a-z])(?=[^/]*$)", re.IGNORECASE)

Views = dict[str, dict[str, Path]]


@dataclass(frozen=True)
class ImageFolder:
    """Image pairs of a folder in natural order; the i-th has the stamp i / rate_hz, the first 0.

    full_scale_16: the value of a 16-bit image that is white.
    """

    pairs: tuple[tuple[Path, Path], ...]
    rate_hz: float
    full_scale_16: int = FULL_SCALE_16

    @staticmethod
    def open(path: Path, rate_hz: float = 10.0, full_scale_16: int = FULL_SCALE_16) -> ImageFolder:
        """Find the pairs in `path` and below it.

        Raises SourceError on a folder without pairs, an image without partner or two of one name;
        ParameterError on a rate that is not positive.
        """
        if not (math.isfinite(rate_hz) and rate_hz > 0):
            raise ParameterError(f"rate_hz = {rate_hz} must be a positive number")
        if not path.is_dir():
            raise SourceError(f"{path}: no such folder of image pairs; check the path")
        views = _views(path)
        names = sorted(views["left"].keys() | views["right"].keys(), key=_natural)
        return ImageFolder(tuple(_pair(views, name) for name in names), rate_hz, full_scale_16)

    @property
    def count(self) -> int:
        """How many pairs there are."""
        return len(self.pairs)

    @property
    def paths(self) -> tuple[Path, ...]:
        """The image files: others in the folder are none of its business."""
        return tuple(file for pair in self.pairs for file in pair)

    @property
    def names(self) -> Mapping[Side, str]:
        """The cameras: each image has a name of its own."""
        return {"left": "the left camera", "right": "the right camera"}

    @property
    def has_stamps(self) -> bool:
        """False: files do not say when their images were taken."""
        return False

    @property
    def cameras(self) -> tuple[Camera, Camera] | None:
        """None: images come without calibration."""
        return None

    def __iter__(self) -> Iterator[SourcePair]:
        """Yield the pairs; raises ImageError on a file that is no image, SourceError on two sizes in one pair."""
        for index, (left_path, right_path) in enumerate(self.pairs):
            left, right = (read_image(path, self.full_scale_16) for path in (left_path, right_path))
            if left.shape[:2] != right.shape[:2]:
                raise SourceError(
                    f"{left_path} is {_size(left)}, but {right_path} is {_size(right)}: both must have one size"
                )
            stamp_ns = round(index * 1e9 / self.rate_hz)
            yield SourcePair(encode(left), encode(right), stamp_ns, stamp_ns)


def _views(folder: Path) -> Views:
    """The images of each side by the name that a left and its right one share."""
    files = [file for file in sorted(folder.rglob("*")) if _is_view(file)]
    for style in _STYLES:
        views: Views = {"left": {}, "right": {}}
        for file in files:
            _add(views, style, folder, file)
        if views["left"] or views["right"]:
            return views
    raise SourceError(
        f"{folder} holds no image pairs: name them left*.png and right*.png, *_left.png and *_right.png, "
        "or put them into subfolders left and right"
    )


def _is_view(file: Path) -> bool:
    words = re.split(r"[^a-z]+", file.stem.lower())
    return file.suffix.lower() in _SUFFIXES and not _NOT_A_VIEW.intersection(words) and file.is_file()


def _add(views: Views, style: re.Pattern[str], folder: Path, file: Path) -> None:
    name = file.relative_to(folder).with_suffix("").as_posix()
    sides = style.findall(name)
    if not sides:
        return
    side = views[sides[-1].lower()]
    # left/left_01.png belongs to right/right_01.png: the file's own side is no part of the common name.
    key = _SIDE_IN_STEM.sub("*", style.sub("*", name))
    if key in side:
        raise SourceError(f"{side[key]} and {file} are the same {sides[-1].lower()} image: remove one of them")
    side[key] = file


def _pair(views: Views, name: str) -> tuple[Path, Path]:
    for some, other in (("left", "right"), ("right", "left")):
        if name not in views[other]:
            raise SourceError(f"{views[some][name]} has no {other} image to go with it: add one, or remove it")
    return views["left"][name], views["right"][name]


def _natural(name: str) -> list[tuple[int, str]]:
    """Sort key in which 2 comes before 10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]


def _size(image: Image) -> str:
    return f"{image.shape[1]} x {image.shape[0]}"
