from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from stereo_pick.core.errors import ImageError, ParameterError, SourceError
from stereo_pick.core.images import pixels
from stereo_pick.sources.images import ImageFolder
from stereo_pick.sources.opening import open_source


def make(folder: Path, *names: str, size: tuple[int, int] = (6, 8)) -> None:
    """Write an image of its own grey value for every name."""
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(path), np.full(size, sum(name.encode()) % 256, np.uint8))


def names(folder: Path) -> list[tuple[str, str]]:
    return [
        (left.relative_to(folder).as_posix(), right.relative_to(folder).as_posix())
        for left, right in ImageFolder.open(folder).pairs
    ]


@pytest.mark.parametrize(
    "lefts",
    [
        ["left1.png", "left2.png", "left10.png"],
        ["left_obj9.jpg", "left_obj10.jpg"],
        ["1_left.tif", "2_left.tif", "11_left.tif"],
        ["scene-left.bmp"],
        ["Left1.PNG", "Left2.PNG"],
        ["left/1.pgm", "left/2.pgm", "left/10.pgm"],
        ["left/left1.png", "left/left2.png"],
        ["set_2/left/a.png", "set_10/left/a.png"],
        ["case_1/left.png", "case_2/left.png", "case_10/left.png"],
        ["one_view/left.png", "two_in_left/left.png"],
        ["left_box/left.png", "right_box/left.png"],
    ],
)
def test_every_way_of_naming_pairs_in_natural_order(tmp_path: Path, lefts: list[str]) -> None:
    rights = [
        "/".join(
            part if part.endswith("_box") or part.startswith("two_") else swapped(part) for part in left.split("/")
        )
        for left in lefts
    ]
    make(tmp_path, *lefts, *rights)
    assert names(tmp_path) == list(zip(lefts, rights))


def swapped(name: str) -> str:
    return name.replace("left", "right").replace("Left", "Right")


def test_the_pairs_hold_the_files_pictures_and_the_rates_stamps(tmp_path: Path) -> None:
    make(tmp_path, "left1.png", "left2.png", "left3.png", "right1.png", "right2.png", "right3.png")
    source = open_source(tmp_path, rate_hz=30.0)
    assert source.count == 3
    assert source.cameras is None
    assert not source.has_stamps
    pairs = list(source)
    for i, pair in enumerate(pairs):
        assert (pixels(pair.left) == sum(f"left{i + 1}.png".encode()) % 256).all()
        assert (pixels(pair.right) == sum(f"right{i + 1}.png".encode()) % 256).all()
        assert pair.stamp_ns == pair.recorded_ns == round(i * 1e9 / 30)
    assert [pair.stamp_ns for pair in source] == [pair.stamp_ns for pair in pairs]


@pytest.mark.parametrize(
    "others",
    [
        ["labels_left.png", "labels_right.png"],
        ["labels_left.png"],
        ["left_labels.png", "left_mask.png", "left_depth.png"],
        ["preview.png", "truth.json", "left.yaml", "right.yaml", "left.txt"],
        ["upright.png", "leftover.png"],
    ],
)
def test_other_files_are_no_views(tmp_path: Path, others: list[str]) -> None:
    make(tmp_path, "case_1/left.png", "case_1/right.png")
    for other in others:
        (tmp_path / "case_1" / other).write_bytes(b"")
    assert names(tmp_path) == [("case_1/left.png", "case_1/right.png")]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (["left1.png", "right1.png", "left2.png"], "left2.png has no right image"),
        (["left1.png", "right1.png", "right2.png"], "right2.png has no left image"),
        (["left/1.png", "left/2.png", "right/2.png"], "left/1.png has no right image"),
        (["left1.png", "left1.jpg", "right1.png"], "left1.jpg and .*left1.png are the same left image"),
        (["a.png", "b.png"], "holds no image pairs: name them left"),
        ([], "holds no image pairs"),
    ],
)
def test_a_folder_without_whole_pairs_is_refused(tmp_path: Path, files: list[str], message: str) -> None:
    make(tmp_path, *files)
    with pytest.raises(SourceError, match=message) as error:
        open_source(tmp_path)
    assert str(tmp_path) in str(error.value)


def test_two_sizes_in_one_pair_are_named_after_the_good_pairs(tmp_path: Path) -> None:
    make(tmp_path, "left1.png", "right1.png", "left2.png")
    make(tmp_path, "right2.png", size=(12, 16))
    pairs = iter(open_source(tmp_path))
    next(pairs)
    with pytest.raises(SourceError, match=r"left2\.png is 8 x 6, but .*right2\.png is 16 x 12"):
        next(pairs)


def test_a_file_that_is_no_image_is_named(tmp_path: Path) -> None:
    make(tmp_path, "left.png", "right.png")
    (tmp_path / "right.png").write_bytes(b"text")
    with pytest.raises(ImageError, match=r"right\.png is no image"):
        list(open_source(tmp_path))


def test_an_absent_folder_is_named(tmp_path: Path) -> None:
    for opening in (open_source, ImageFolder.open):
        with pytest.raises(SourceError, match="nowhere: no such"):
            opening(tmp_path / "nowhere")


@pytest.mark.parametrize("rate_hz", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_rate_is_refused(tmp_path: Path, rate_hz: float) -> None:
    make(tmp_path, "left.png", "right.png")
    with pytest.raises(ParameterError, match="rate_hz"):
        open_source(tmp_path, rate_hz=rate_hz)


def test_what_is_neither_file_nor_folder_is_named(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.mcap")
    for path in (tmp_path / "pipe.mcap", Path("/dev/null")):
        with pytest.raises(SourceError, match=f"{path} is no bag .* and no folder of image pairs"):
            open_source(path)


def test_topics_are_no_folders(tmp_path: Path) -> None:
    make(tmp_path, "left1.png", "right1.png")
    with pytest.raises(SourceError, match="is a folder of images, which has no topics: leave out left_topic"):
        open_source(tmp_path, right_topic="/right/image_raw")
