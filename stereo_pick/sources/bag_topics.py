"""Which topics of a bag are the left and the right raw images."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from stereo_pick.core.errors import SourceError

if TYPE_CHECKING:  # a host that only rectifies needs no bag reader
    from rosbags.interfaces import TopicInfo

COMPRESSED_TYPE = "sensor_msgs/msg/CompressedImage"
_IMAGE_TYPES = ("sensor_msgs/msg/Image", COMPRESSED_TYPE)
_BOTH = "left_topic and right_topic (--left-topic and --right-topic)"
_OTHER = {"left": "right", "right": "left"}
_RIGHT_OF = {"left": "right", "Left": "Right", "LEFT": "RIGHT"}
_LEFT = re.compile(r"(?<![A-Za-z])(left|Left|LEFT)(?![A-Za-z])")


def choose_topics(topics: Mapping[str, TopicInfo], left: str = "", right: str = "") -> tuple[str, str]:
    """Return the left and the right image topic: those given, the others found by their names.

    Two topics belong together where `left` in the one's name stands for `right` in the other's; raw
    images are preferred to others and uncompressed ones to compressed ones.
    Raises SourceError, with the topics that there are, where none or several would do.
    """
    images = sorted(
        name
        for name, topic in topics.items()
        if topic.msgtype in _IMAGE_TYPES and not name.endswith("/compressedDepth")
    )
    if not images:
        raise SourceError(f"no image topic among its topics ({_listed(topics)}): record image_raw of both cameras")
    given = [("left", left), ("right", right)]
    for side, name in given:
        if name and name not in images:
            raise SourceError(f"{_option(side, name)} is none of its image topics: {_listed(images)}")
    if left and left == right:
        raise SourceError(f"{_BOTH} are both {left}: name the two cameras' topics")
    if left and right:
        return left, right
    partners = _partners(images)
    for (side, name), of_other in zip(given, (set(partners.values()), set(partners))):
        if name in of_other:
            raise SourceError(
                f"{_option(side, name)} is the {_OTHER[side]} one of {_listed(images)}, by its name: exchange them, or "
                f"set {_BOTH} if it is the {side} one all the same"
            )
    return _only_one(_candidates(topics, partners, left, right), images)


def camera_info_topic(image_topic: str) -> str:
    """The camera_info topic beside an image topic."""
    namespace, slash, _ = _uncompressed(image_topic).rpartition("/")
    return f"{namespace}{slash}camera_info"


def is_rectified(topic: str) -> bool:
    """Whether an image topic's name says that its images are rectified."""
    return "rect" in _uncompressed(topic).rpartition("/")[2]


def _partners(images: list[str]) -> dict[str, str]:
    """The right topic of each left one that has one, by their names."""
    partners = {name: _LEFT.sub(lambda match: _RIGHT_OF[match[0]], name) for name in images if _LEFT.search(name)}
    return {name: right for name, right in partners.items() if right in images}


def _candidates(
    topics: Mapping[str, TopicInfo], partners: Mapping[str, str], left: str, right: str
) -> list[tuple[str, str]]:
    """The best of the left and right topics that belong together and agree with the given ones."""
    pairs = [pair for pair in partners.items() if left in ("", pair[0]) and right in ("", pair[1])]
    if left or right:
        return pairs
    if pairs and all(is_rectified(name) for name, _ in pairs):
        raise SourceError(
            f"only rectified images ({pairs[0][0]}), but raw ones are needed: record image_raw, "
            f"or set {_BOTH} if these are raw all the same"
        )

    def rank(pair: tuple[str, str]) -> tuple[bool, bool, bool]:
        silent = any(topics[name].msgcount == 0 for name in pair)
        return silent, not _uncompressed(pair[0]).endswith("image_raw"), _uncompressed(pair[0]) != pair[0]

    raw = [pair for pair in pairs if not is_rectified(pair[0])]
    return [pair for pair in raw if rank(pair) == min(map(rank, raw))]


def _only_one(pairs: list[tuple[str, str]], images: list[str]) -> tuple[str, str]:
    if len(pairs) == 1:
        return pairs[0]
    if pairs:
        choices = ", ".join(f"{left} with {right}" for left, right in pairs)
        raise SourceError(f"several stereo cameras: {choices}; choose one by {_BOTH}")
    raise SourceError(
        f"no image topics whose names differ in left and right alone, but {_listed(images)}: "
        f"set {_BOTH}, or record both cameras"
    )


def _option(side: str, name: str) -> str:
    """The choice of a topic, as a parameter and as an option."""
    return f"{side}_topic = {name} (--{side}-topic)"


def _uncompressed(topic: str) -> str:
    return topic.removesuffix("/compressed")


def _listed(names: Mapping[str, TopicInfo] | list[str]) -> str:
    return ", ".join(sorted(names)) or "none"
