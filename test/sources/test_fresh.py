"""Recordings in which a camera hung."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recordings import DEMO_BAG, Recording, write_images

from stereo_pick.core.hanging import STILL
from stereo_pick.sources.fresh import FreshPairs
from stereo_pick.sources.opening import open_source

VIEWS = [np.random.default_rng(seed).integers(0, 256, (8, 12), np.uint8) for seed in range(12)]


def indices(pairs: FreshPairs) -> list[int]:
    """Which pairs come, by their stamps."""
    stamps_ns = [pair.stamp_ns for pair in pairs]
    return [round((each - stamps_ns[0]) / 1e8) for each in stamps_ns]


@pytest.mark.parametrize("names", [("/left/image_raw", "/right/image_raw"), ("the left camera", "the right camera")])
def test_pairs_of_a_camera_that_hung_are_left_out_and_told_of(names: tuple[str, str], tmp_path: Path) -> None:
    lefts, rights = [0, 1, 1, 1, 2, 3], [4, 5, 6, 7, 8, 8]
    pairs = [(VIEWS[left], VIEWS[right]) for left, right in zip(lefts, rights)]
    of_bag = names[0].startswith("/")
    path = Recording(pairs).write(tmp_path / "bag") if of_bag else write_images(tmp_path / "images", pairs)
    fresh = FreshPairs(open_source(path))
    assert indices(fresh) == [0, 1, 4]
    assert fresh.read == 6
    of_left, of_right = fresh.warnings
    assert of_left.startswith(f"2 of 6 pairs, the first of them number 3, are refused: {names[0]} repeats the image")
    assert of_right.startswith(f"1 of 6 pairs, the first of them number 6, are refused: {names[1]} repeats the image")


@pytest.mark.parametrize("still", [STILL - 1, STILL])
def test_pairs_that_are_all_the_same_come_and_many_are_told_of(still: int, tmp_path: Path) -> None:
    """A simulation without noise, in which nothing moves, looks like that."""
    alike = [(VIEWS[0], VIEWS[1])] * (1 + still)
    fresh = FreshPairs(open_source(Recording([*alike, (VIEWS[2], VIEWS[3])]).write(tmp_path / "bag")))
    assert indices(fresh) == list(range(still + 2))
    assert [text.partition(":")[0] for text in fresh.warnings] == (
        [f"{STILL} pairs in a row are the same to the last bit"] if still == STILL else []
    )


def test_in_the_demo_bag_no_camera_hangs() -> None:
    source = open_source(DEMO_BAG)
    fresh = FreshPairs(source)
    assert len(list(fresh)) == source.count and fresh.warnings == []
