"""Each bad input, given to a command or a real node process: one line with thing, value and remedy, and no pose."""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
import sqlite3
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from recordings import DEMO_RIG, Recording, demo_pairs, write_images
from ros_tools import System, stereo_pick_here
from rosbags.rosbag2 import StoragePlugin

from stereo_pick.core.calibration.files import load_rig
from stereo_pick.core.images import ImageBuffer, encode

RIG = load_rig(DEMO_RIG)


@dataclass(frozen=True)
class Good:
    """What the bad inputs are made of: a bag, its pairs, and the same as files."""

    bag: Path
    pairs: list[Any]
    images: Path


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Good:
    folder = tmp_path_factory.mktemp("good")
    pairs = demo_pairs(3)
    bag = Recording.of(RIG, *pairs).write(folder / "bag")
    return Good(bag, pairs, write_images(folder / "images", pairs[:1]))


def the_line(line: str, parts: list[str]) -> None:
    for part in parts:
        assert part in line, (part, line)


def only_error(output: str) -> str:
    """The one line of a child's output that tells of an error."""
    lines = [line for line in output.splitlines() if "error" in line]
    assert len(lines) == 1, output
    return lines[0]


def replay(*args: str | Path) -> tuple[str, list[Any]]:
    """The error of a `stereo-pick replay` that cannot go on, and the objects it has printed before."""
    done = stereo_pick_here("replay", *args)
    return done.error, [each for line in done.stdout.splitlines() for each in json.loads(line)["objects"]]


def capture_refuses(system: System, source: Path, parts: list[str], **values: Any) -> None:
    """The capture node ends with status 1 and one line."""
    child = system.start_node("capture", {"source": source, "wait_for_subscribers_s": 0.0, "rate": 50.0, **values})
    assert child.wait() == 1
    line = only_error(child.output)
    assert line.startswith("stereo-pick: error: ")
    the_line(line, parts)


def without_images(good: Good, folder: Path) -> Path:
    recording = Recording.of(RIG, *good.pairs)
    return dataclasses.replace(recording, leave_out=("/left/image_raw", "/right/image_raw")).write(folder / "bag")


def one_camera(good: Good, folder: Path) -> Path:
    return dataclasses.replace(Recording.of(RIG, *good.pairs), leave_out=("/right/image_raw",)).write(folder / "bag")


def one_silent_camera(good: Good, folder: Path) -> Path:
    """The right camera's topic is there, but nothing was ever sent on it."""
    bag = dataclasses.replace(Recording.of(RIG, *good.pairs), plugin=StoragePlugin.SQLITE3).write(folder / "bag")
    (file,) = bag.glob("*.db3")
    with sqlite3.connect(file) as connection:
        connection.execute(
            "DELETE FROM messages WHERE topic_id IN (SELECT id FROM topics WHERE name='/right/image_raw')"
        )
    (bag / "metadata.yaml").unlink()
    return file


def without_calibration(good: Good, folder: Path) -> Path:
    return Recording(good.pairs).write(folder / "bag")


def no_bag(good: Good, folder: Path) -> Path:
    return folder / "nothing"


def empty_folder(good: Good, folder: Path) -> Path:
    (folder / "images").mkdir()
    (folder / "images" / "notes.txt").write_text("no images here")
    return folder / "images"


def left_only(good: Good, folder: Path) -> Path:
    images = shutil.copytree(good.images, folder / "images")
    (images / "right00.png").unlink()
    return images


def truncated(good: Good, folder: Path) -> Path:
    """A recording that was cut off: no index, no metadata, and its last message half there."""
    return cut_short(good.bag, folder / "cut.mcap", 0.7)


def cut_short(bag: Path, target: Path, part: float) -> Path:
    (file,) = bag.glob("*.mcap")
    data = file.read_bytes()
    target.write_bytes(data[: int(len(data) * part)])
    return target


def garbage(good: Good, folder: Path) -> Path:
    (folder / "garbage.mcap").write_bytes(bytes(range(256)) * 400)
    return folder / "garbage.mcap"


def flipped(good: Good, folder: Path) -> Path:
    """As rosbag2 writes it, with checksums; some bytes in the middle of the last chunk are wrong."""
    (file,) = good.bag.glob("*.mcap")
    target = folder / "flipped.mcap"
    with file.open("rb") as source, target.open("wb") as stream:
        writer = Writer(stream, chunk_size=100_000, compression=CompressionType.NONE)
        writer.start(profile="ros2", library="test")
        channels: dict[str, int] = {}
        for schema, channel, message in make_reader(source).iter_messages():
            assert schema is not None
            if channel.topic not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, "cdr", schema_id)
            writer.add_message(channels[channel.topic], message.log_time, message.data, message.publish_time)
        writer.finish()
    data = bytearray(target.read_bytes())
    middle = int(len(data) * 0.8)
    data[middle : middle + 64] = bytes(64 * [0xA5])
    target.write_bytes(data)
    return target


UNREADABLE: dict[str, tuple[Callable[[Good, Path], Path], list[str]]] = {
    "a bag without the topics": (without_images, ["no image topic", "/left/camera_info", "record image_raw"]),
    "one camera missing": (one_camera, ["/left/image_raw", "record both cameras"]),
    "one camera silent": (one_silent_camera, ["/right/image_raw has no images", "camera running", "3"]),
    "no calibration": (without_calibration, ["no camera_info", "calibration"]),
    "no bag": (no_bag, ["nothing", "no such bag", "check the path"]),
    "a folder without pairs": (empty_folder, ["no image pairs", "left*.png"]),
    "a folder with one side": (left_only, ["left00.png", "no right image", "add one"]),
    "a file that is no bag": (garbage, ["garbage.mcap cannot be read", "mcap recover", "record it again"]),
    "a truncated bag": (truncated, ["cut.mcap cannot be read", "mcap recover", "record it again"]),
}


@pytest.mark.parametrize("case", UNREADABLE)
def test_what_cannot_be_read_is_refused_by_every_command_and_by_the_node(
    case: str, good: Good, system: System, tmp_path: Path
) -> None:
    make, parts = UNREADABLE[case]
    source = make(good, tmp_path)
    capture = system.start_node("capture", {"source": source, "wait_for_subscribers_s": 0.0})
    line, objects = replay(source)
    the_line(line, [str(source), *parts])
    assert objects == []
    ran = stereo_pick_here("run", "--source", source)
    the_line(ran.error, [str(source), *parts])
    assert ran.stdout == ""
    assert capture.wait() == 1
    (told,) = capture.output.splitlines()
    the_line(told, [str(source), *parts])


def test_a_bag_with_damage_gives_what_came_before_and_then_names_the_damage(
    good: Good, system: System, tmp_path: Path
) -> None:
    source = flipped(good, tmp_path)
    parts = [str(source), "cannot be read beyond", "mcap recover"]
    capture = system.start_node("capture", {"source": source, "wait_for_subscribers_s": 0.0, "rate": 50.0})
    line, objects = replay(source)
    the_line(line, parts)
    assert len(objects) in (4, 8)
    to_bag = stereo_pick_here("replay", source, "--output", tmp_path / "poses.mcap")
    the_line(to_bag.error, parts)
    assert list(tmp_path.glob("poses*")) == []
    assert capture.wait() == 1
    the_line(capture.output.splitlines()[-1], parts)
    assert "Traceback" not in capture.output


def test_run_shows_what_came_before_the_damage_and_ends_with_status_1(
    good: Good, tmp_path: Path, system: System
) -> None:
    source = flipped(good, tmp_path)
    child = system.start_command("run", "--source", str(source), "--rate", "0.3")
    assert child.wait() == 1
    shown = [line for line in child.output.splitlines() if re.match(r"\d+\.\d+ left_eye ", line)]
    assert 1 <= len(shown) <= 2
    line = only_error(child.output)
    the_line(line, ["stereo-pick: error: ", str(source), "cannot be read beyond"])


def _buffer(picture: Any, **changes: Any) -> ImageBuffer:
    return dataclasses.replace(encode(picture), **changes)


BAD_IMAGES: dict[str, tuple[Mapping[str, Any], list[str]]] = {
    "unknown encoding": ({"encoding": "bayer_rggb8"}, ["left image", "unknown encoding 'bayer_rggb8'", "debayer"]),
    "shorter than its header says": ({"data": bytes(1000)}, ["left image", "1000 bytes", "307200", "cut short"]),
    "another size": (
        {"width_px": 320, "height_px": 240, "step_bytes": 320, "data": bytes(320 * 240)},
        ["left image is 320 x 240", "640 x 480", "calibrate at the resolution"],
    ),
}


@pytest.mark.parametrize("case", BAD_IMAGES)
def test_a_bag_with_a_bad_image_is_replayed_up_to_it(case: str, good: Good, tmp_path: Path) -> None:
    changes, parts = BAD_IMAGES[case]
    (left, right), *_ = good.pairs
    bag = Recording.of(RIG, (left, right), (_buffer(left, **changes), right)).write(tmp_path / "bag")
    line, objects = replay(bag)
    the_line(line, parts)
    assert len(objects) == 4


def test_pairs_of_a_camera_that_hung_are_no_poses_of_replay_but_counted(good: Good, tmp_path: Path) -> None:
    """Parts that moved on would be located where they never were, and surely; the nodes refuse these pairs, too."""
    (left, right), (_, moved), (_, on) = good.pairs
    bag = Recording.of(RIG, (left, right), (left, moved), (left, on), good.pairs[1]).write(tmp_path / "bag")
    stamps_ns = Recording.of(RIG, *range(4)).stamps_ns()
    for output in ([], ["--output", tmp_path / "poses.jsonl"]):
        done = stereo_pick_here("replay", bag, *output)
        lines = (tmp_path / "poses.jsonl").read_text() if output else done.stdout
        assert [json.loads(line)["stamp_ns"] for line in lines.splitlines()] == [stamps_ns[0], stamps_ns[3]]
        assert done.status == 0 and done.stderr.count("\n") == 1
        the_line(
            done.stderr, ["warning: 2 of 4 pairs, the first of them number 2, are refused: /left/image_raw repeats"]
        )
        the_line(done.stderr, ["to the last bit, while the other camera's changes: does the camera hang? Restart it"])


def test_run_tells_what_the_nodes_complain_of_and_ends_with_status_1(
    good: Good, tmp_path: Path, system: System
) -> None:
    half = [tuple(cv2.resize(view, (320, 240)) for view in pair) for pair in good.pairs]
    bag = Recording.of(RIG, *half).write(tmp_path / "bag")
    child = system.start_command("run", "--source", str(bag), "--rate", "0.3")
    assert child.wait() == 1
    line = only_error(child.output)
    the_line(line, ["stereo-pick: error: ", "left image is 320 x 240", "640 x 480", "calibrate"])
    assert "0 pose arrays received for 3 pairs" in child.output


def test_a_picture_in_the_place_of_an_image_is_refused_by_locate(good: Good, tmp_path: Path) -> None:
    image = tmp_path / "left.png"
    image.write_bytes(b"the only copy")
    done = stereo_pick_here("locate", image, image, "--calibration", DEMO_RIG, "--picture", tmp_path / "." / "left.png")
    the_line(done.error, ["left.png is one of the two images", "give another file"])
    assert image.read_bytes() == b"the only copy"


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("/proc/seen.png", "No such file or directory; give a file in a folder that exists"),
        ("folder.png", "Is a directory"),
        ("full.png", "No space left on device"),
        ("seen.txt", "give a .png or .jpg file"),
    ],
)
def test_a_picture_that_cannot_be_written_is_refused_by_locate_with_the_reason(
    name: str, reason: str, good: Good, tmp_path: Path
) -> None:
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "full.png").symlink_to("/dev/full")
    images = [good.images / f"{side}00.png" for side in ("left", "right")]
    done = stereo_pick_here("locate", *images, "--calibration", DEMO_RIG, "--picture", tmp_path / name)
    the_line(done.error, [f"{tmp_path / name} cannot be written: {reason}"])
    assert done.error.endswith(reason)


def test_an_output_in_the_place_of_the_recording_is_refused_by_replay(good: Good, tmp_path: Path) -> None:
    bag, images = shutil.copytree(good.bag, tmp_path / "bag"), shutil.copytree(good.images, tmp_path / "images")
    (file,) = bag.glob("*.mcap")
    (tmp_path / "link.jsonl").symlink_to(images / "left00.png")
    kept = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}
    for source, output in (
        (bag, file),
        (bag, bag / "metadata.yaml"),
        (bag, bag / "poses.jsonl"),
        (file, bag / ".." / "bag" / file.name),
        (images, images / "left00.png"),
        (images, tmp_path / "link.jsonl"),
    ):
        line, objects = replay(source, "--calibration", DEMO_RIG, "--output", output)
        the_line(line, [f"--output {output} is part of the recording", "give another file"])
        assert objects == []
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()} == kept
    beside = stereo_pick_here("replay", images, "--calibration", DEMO_RIG, "--output", images / "poses.jsonl")
    assert (beside.status, beside.stderr) == (0, "")


def test_an_output_of_another_kind_is_refused_by_replay(good: Good, tmp_path: Path) -> None:
    for name in ("poses.db3", "poses.json", "poses"):
        line, objects = replay(good.bag, "--output", tmp_path / name)
        the_line(line, [f"--output {tmp_path / name} must end in .jsonl", ".mcap"])
        assert objects == []
    line, _ = replay(good.images, "--calibration", DEMO_RIG, "--output", tmp_path / "poses.mcap")
    the_line(line, ["poses.mcap: a folder of images cannot become a bag of poses: give a .jsonl file"])
    assert list(tmp_path.iterdir()) == []


def test_images_of_another_size_are_refused_by_locate(good: Good, tmp_path: Path) -> None:
    small = [cv2.resize(view, (320, 240)) for view in good.pairs[0]]
    folder = write_images(tmp_path / "small", [(small[0], small[1])])
    done = stereo_pick_here("locate", folder / "left00.png", folder / "right00.png", "--calibration", DEMO_RIG)
    the_line(done.error, ["320 x 240", "640 x 480", "calibrate"])
    assert done.stdout == ""


def test_exchanged_images_are_refused_by_every_command(good: Good, tmp_path: Path) -> None:
    left, right = good.images / "left00.png", good.images / "right00.png"
    for output in ([], ["--json"]):
        done = stereo_pick_here("locate", right, left, "--calibration", DEMO_RIG, *output)
        the_line(done.error, [str(right), "exchanged", "give the left image first"])
    assert json.loads(done.stdout)["objects"] == []
    swapped = write_images(tmp_path / "swapped", [pair[::-1] for pair in good.pairs])
    line, objects = replay(swapped, "--calibration", DEMO_RIG)
    the_line(line, ["exchanged", "3 pairs", "exchange --left-topic and --right-topic, or the files"])
    assert objects == []


def test_a_camera_that_has_turned_a_little_is_told_and_made_up_for(good: Good, tmp_path: Path) -> None:
    turned = write_images(tmp_path / "turned", [(left, np.roll(right, 1, axis=0)) for left, right in good.pairs])
    done = stereo_pick_here("replay", turned, "--calibration", DEMO_RIG)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.status == 0 and [len(line["objects"]) for line in lines] == [4, 4, 4]
    assert all(0.8 < line["turned_px"] < 1.2 for line in lines)
    the_line(done.stderr, ["warning: objects are 1.0 rows off", "a camera has turned", "calibrate again"])
    done = stereo_pick_here("locate", turned / "left00.png", turned / "right00.png", "--calibration", DEMO_RIG)
    assert done.status == 0
    the_line(done.stdout, ["a camera has turned", "calibrate again"])


def test_exchanged_topics_are_refused_by_every_command(good: Good, system: System) -> None:
    topics = ("--left-topic", "/right/image_raw", "--right-topic", "/left/image_raw")
    run = system.start_command(
        "run", "--source", str(good.bag), *topics, "--calibration", str(DEMO_RIG), "--rate", "0.3"
    )
    line, objects = replay(good.bag, *topics)
    the_line(line, ["P[0,3] of the left camera = -2", "swapped", "exchange"])
    assert objects == []
    line, objects = replay(good.bag, *topics, "--calibration", DEMO_RIG)
    the_line(line, ["exchanged", "--left-topic and --right-topic"])
    assert objects == []
    capture_refuses(
        system, good.bag, ["P[0,3]", "swapped"], left_topic="/right/image_raw", right_topic="/left/image_raw"
    )
    assert run.wait() == 1
    told = only_error(run.output)
    the_line(told, ["exchanged", "exchange the two image topics"])
    assert "no object" in run.output
    assert " 1: " not in run.output


def spoilt(folder: Path, side: str, field: str, index: int, change: Callable[[float], float]) -> Path:
    """The demo rig's calibration, one number of it changed."""
    folder = shutil.copytree(DEMO_RIG, folder)
    (folder / "stereo.yaml").unlink()
    file = folder / f"{side}.yaml"
    content = yaml.safe_load(file.read_text())
    content[field]["data"][index] = change(content[field]["data"][index])
    file.write_text(yaml.safe_dump(content))
    return folder


BAD_CALIBRATIONS: dict[str, tuple[Callable[[Path], Path], list[str]]] = {
    "zero baseline": (
        lambda path: spoilt(path, "right", "projection_matrix", 3, lambda value: 0.0),
        ["baseline = 0.000 mm is zero", "stereo pair"],
    ),
    "negative baseline": (
        lambda path: spoilt(path, "right", "projection_matrix", 3, lambda value: -value),
        ["baseline", "negative", "exchange"],
    ),
    "in millimetres": (
        lambda path: spoilt(path, "right", "projection_matrix", 3, lambda value: value * 1000),
        ["baseline = 210.3 m", "millimetres", "divide"],
    ),
    "NaN": (
        lambda path: spoilt(path, "left", "camera_matrix", 4, lambda value: float("nan")),
        ["left.yaml", "holds nan", "finite"],
    ),
    "infinite distortion": (
        lambda path: spoilt(path, "left", "distortion_coefficients", 0, lambda value: float("inf")),
        ["left.yaml", "holds inf", "finite"],
    ),
    "absent": (lambda path: path, ["no such calibration folder"]),
}


@pytest.mark.parametrize("case", BAD_CALIBRATIONS)
def test_a_calibration_that_cannot_be_is_refused_by_every_command_and_by_the_node(
    case: str, good: Good, tmp_path: Path, system: System
) -> None:
    make, parts = BAD_CALIBRATIONS[case]
    rig = make(tmp_path / "rig")
    capture = system.start_node("capture", {"source": good.bag, "calibration": rig})
    refused_by_every_command(good, rig, parts)
    assert capture.wait() == 1
    (told,) = capture.output.splitlines()
    the_line(told, [str(rig), *parts])


def refused_by_every_command(good: Good, rig: Path, parts: list[str]) -> None:
    images = [good.images / f"{side}00.png" for side in ("left", "right")]
    for arguments in (["locate", *images], ["replay", good.bag], ["run", "--source", good.bag]):
        done = stereo_pick_here(*arguments, "--calibration", rig)
        the_line(done.error, [str(rig), *parts])
        assert done.stdout == ""


def test_an_empty_folder_for_a_calibration_is_refused_by_every_command(good: Good, tmp_path: Path) -> None:
    """Not by the capture node, where set_camera_info may fill it."""
    (tmp_path / "rig").mkdir()
    refused_by_every_command(good, tmp_path / "rig", ["left.yaml and right.yaml", "empty"])


def test_an_uncalibrated_camera_in_the_bag_is_named(good: Good, tmp_path: Path) -> None:
    bag = Recording.of(RIG, *good.pairs[:1]).write(tmp_path / "bag")
    # What a driver without calibration sends: zeros. The bag's own writer would not make such a camera.
    (file,) = bag.glob("*.mcap")
    data = file.read_bytes()
    focal = np.array([RIG.left.K[0, 0]]).tobytes()
    assert focal in data
    file.write_bytes(data.replace(focal, bytes(8)))
    line, objects = replay(bag)
    the_line(line, ["/left/camera_info", "focal length", "calibrated"])
    assert objects == []


def test_an_empty_table_is_no_error(tmp_path: Path, shared_data: Path) -> None:
    table = shared_data / "bench_rig" / "empty" / "table"
    done = stereo_pick_here("locate", table / "left.png", table / "right.png", "--calibration", DEMO_RIG, "--json")
    assert (done.status, done.stderr) == (0, "")
    assert json.loads(done.stdout)["objects"] == []
    done = stereo_pick_here("locate", table / "left.png", table / "right.png", "--calibration", DEMO_RIG)
    assert (done.status, done.stderr) == (0, "")
    assert "no object" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--method", "feature", "--param", "segmentation.polarity=grey"], ["polarity = 'grey'", "auto, bright, dark"]),
        (["--param", "segmentation.min_area_px=0"], ["min_area_px = 0", "1 .. 1e+06"]),
        (["--param", "segmentation.nonsense=1"], ["segmentation.nonsense", "parameter"]),
        (["--param", "segmentation.polarity"], ["'segmentation.polarity'", "name=value"]),
    ],
)
def test_a_bad_parameter_is_named(good: Good, arguments: list[str], parts: list[str]) -> None:
    images = [good.images / f"{side}00.png" for side in ("left", "right")]
    the_line(stereo_pick_here("locate", *images, "--calibration", DEMO_RIG, *arguments).error, parts)


def test_an_image_file_that_is_none_is_named(good: Good, tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes((good.images / "left00.png").read_bytes()[:2000])
    for left, parts in (
        (tmp_path / "broken.png", ["damaged or cut short"]),
        (tmp_path / "none.png", ["no such image"]),
    ):
        done = stereo_pick_here("locate", left, good.images / "right00.png", "--calibration", DEMO_RIG)
        the_line(done.error, [str(left), *parts])
