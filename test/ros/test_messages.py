"""Every message type there and back through its serialized form, and what is of another make refused."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import pytest
import rigs
from rclpy.serialization import deserialize_message, serialize_message
from rigs import rotation
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from visualization_msgs.msg import Marker

from stereo_pick.core.confidence import within
from stereo_pick.core.correspondence import Correspondences
from stereo_pick.core.errors import ArrayError, CalibrationError, ImageError, StereoPickError
from stereo_pick.core.images import ImageBuffer, pixels
from stereo_pick.core.places.extent import KINDS, Extent
from stereo_pick.core.poses import ObjectPoses
from stereo_pick.core.refusal import REASONS, Refusal
from stereo_pick.ros.messages.cameras import camera_info_message, camera_of, content
from stereo_pick.ros.messages.correspondences import correspondences_message, correspondences_of
from stereo_pick.ros.messages.diagnostics import ERROR, Status, diagnostics_message
from stereo_pick.ros.messages.images import buffer_message, buffer_of, image_message
from stereo_pick.ros.messages.poses import OBJECT_ROW, markers_message, objects_message, pose_array_message
from stereo_pick.ros.messages.stamps import stamp_ns, time_message
from stereo_pick.ros.messages.tables import TableError, table_message, table_of

STAMP_NS = 1_760_000_000_123_456_789
RNG = np.random.default_rng(5)
ENCODINGS = {
    "mono8": (1, 1), "8UC1": (1, 1), "mono16": (1, 2), "16UC1": (1, 2), "bgr8": (3, 1), "8UC3": (3, 1),
    "rgb8": (3, 1), "bgra8": (4, 1), "rgba8": (4, 1),
    "yuv422": (2, 1), "uyvy": (2, 1), "yuv422_yuy2": (2, 1), "yuyv": (2, 1),
}  # fmt: skip


def sent(message: Any) -> Any:
    """The message as a subscriber receives it."""
    return deserialize_message(serialize_message(message), type(message))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("padding", [0, 6])
def test_an_image_of_every_encoding_comes_back(encoding: str, padding: int) -> None:
    channels, depth = ENCODINGS[encoding]
    row = 7 * channels * depth
    rows = RNG.integers(0, 256, (5, row + padding), np.uint8)
    buffer = ImageBuffer(7, 5, row + padding, encoding, False, rows.tobytes())

    message = sent(buffer_message(buffer, STAMP_NS, "left_eye"))
    assert (message.width, message.height, message.step, message.encoding) == (7, 5, row + padding, encoding)
    assert (stamp_ns(message.header.stamp), message.header.frame_id) == (STAMP_NS, "left_eye")
    assert bytes(message.data) == rows.tobytes()

    values = rows[:, :row].reshape(5, 7, channels * depth)
    decoded = pixels(buffer_of(message))
    if depth == 2:
        true = (values[..., 0] + 256.0 * values[..., 1]) * 255 / 65535
        assert np.abs(decoded - true).max() <= 0.5
    elif channels == 1:
        assert (decoded == values[..., 0]).all()
    elif channels == 2:
        assert (decoded == values[..., 1 if encoding in ("yuv422", "uyvy") else 0]).all()
    else:
        assert (decoded == (values[..., 2::-1] if encoding.startswith("rgb") else values[..., :3])).all()


@pytest.mark.parametrize(("shape", "encoding"), [((4, 6), "mono8"), ((4, 6, 3), "bgr8")])
def test_a_picture_becomes_an_image_message(shape: tuple[int, ...], encoding: str) -> None:
    picture = RNG.integers(0, 256, shape, np.uint8)
    message = sent(image_message(picture, STAMP_NS, "eye"))
    assert message.encoding == encoding
    assert (pixels(buffer_of(message)) == picture).all()


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"encoding": "bayer_rggb8"}, ["unknown encoding 'bayer_rggb8'", "debayer"]),
        ({"encoding": "nv21"}, ["unknown encoding 'nv21'", "mono8"]),
        ({"height": 5}, ["24 bytes", "30", "cut short"]),
        ({"step": 3}, ["step = 3", "6 bytes"]),
        ({"width": 0}, ["0 x 4", "positive"]),
    ],
)
def test_an_image_message_that_contradicts_itself_is_refused(change: dict[str, Any], parts: list[str]) -> None:
    message = image_message(np.zeros((4, 6), np.uint8), STAMP_NS, "eye")
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(ImageError) as error:
        pixels(buffer_of(sent(message)), what="left image")
    for part in ["left image", *parts]:
        assert part in str(error.value)


@pytest.mark.parametrize("name", rigs.RIGS)
def test_camera_info_holds_the_camera_to_the_last_bit(name: str) -> None:
    rig = rigs.RIGS[name]
    for camera in (rig.left, rig.right):
        message = sent(camera_info_message(camera, STAMP_NS, "eye"))
        back = camera_of(message, camera.name)
        assert back.frame_size == camera.frame_size
        assert back.distortion_model == camera.distortion_model
        for matrix in "KDRP":
            assert (getattr(back, matrix) == getattr(camera, matrix)).all()
    fx = message.p[0]
    assert message.p[3] == pytest.approx(-fx * np.linalg.norm(rig.right_T_left.translation), rel=1e-9)


def test_camera_info_of_another_header_is_the_same_camera() -> None:
    left = rigs.RIGS["verged"].left
    one, other = camera_info_message(left, 1, "a"), camera_info_message(left, 2, "b")
    assert content(one) == content(other)
    other.p[3] = 1e-9
    assert content(one) != content(other)


def test_a_region_of_interest_is_another_camera() -> None:
    left = rigs.RIGS["verged"].left
    full, region = (camera_info_message(left, STAMP_NS, "eye") for _ in range(2))
    region.roi.x_offset, region.roi.width, region.binning_x, region.binning_y = 40, 600, 2, 2
    assert content(full) != content(region)
    camera = camera_of(sent(region), "left")
    assert camera.frame_size == (300, 240)
    assert camera.K[0, 2] == pytest.approx((left.K[0, 2] - 40.5) / 2)
    region.roi.x_offset = 41
    with pytest.raises(CalibrationError, match=r"region of interest, 600 x 480 pixels at \(41, 0\)"):
        camera_of(region, "left")


def test_camera_info_of_an_uncalibrated_driver_is_refused() -> None:
    with pytest.raises(CalibrationError, match="left camera: focal length.*calibrated"):
        camera_of(CameraInfo(width=640, height=480, distortion_model="plumb_bob", r=np.eye(3).ravel()), "left")


def correspondences(count: int = 3) -> Correspondences:
    def columns(n: int) -> np.ndarray:
        return RNG.uniform(1, 600, (count, n))

    refused = [Refusal("merged", np.array([1.5, 2.5]), None), Refusal("right_only", None, np.array([3.5, 4.5]))]
    refused += [Refusal(reason, np.array([1.0, 2.0]), np.array([3.0, 4.0])) for reason in REASONS]
    box = Extent("box", rotation((0.1, -0.4, 2.0)), np.array([0.05, 0.04, 0.03]))
    ball = Extent("sphere", np.eye(3), np.full(3, 0.02))
    extents = (box, None, ball)[:count]
    roots = RNG.normal(size=(count, 3, 3))
    return Correspondences(
        columns(2),
        columns(2),
        columns(2),
        columns(2),
        columns(1)[:, 0],
        tuple(refused),
        extents,
        roots @ roots.transpose(0, 2, 1),
    )


@pytest.mark.parametrize("count", [0, 1, 3])
def test_correspondences_come_back_with_their_refusals(count: int) -> None:
    before = correspondences(count)
    message = sent(correspondences_message(before, STAMP_NS, "eye"))
    after = correspondences_of(message)
    for name in ("left_px", "right_px", "sigma_px", "size_px", "direction_rad"):
        assert (getattr(after, name) == getattr(before, name)).all()
    np.testing.assert_allclose(after.covariance, before.covariance, rtol=1e-12)
    for one, other in zip(after.extents, before.extents, strict=True):
        assert (one is None) == (other is None)
        if one is not None and other is not None:
            assert one.kind == other.kind and (one.size_m == other.size_m).all()
            np.testing.assert_allclose(one.rotation, other.rotation, atol=1e-9)
    assert [refusal.reason for refusal in after.refused] == [refusal.reason for refusal in before.refused]
    for one, other in zip(after.refused, before.refused):
        for side in ("left_px", "right_px"):
            assert np.array_equal(getattr(one, side), getattr(other, side))
    assert (stamp_ns(message.header.stamp), message.header.frame_id) == (STAMP_NS, "eye")


def test_no_correspondences_at_all_come_back() -> None:
    none = np.zeros((0, 2))
    after = correspondences_of(
        sent(correspondences_message(Correspondences(none, none, none, none, none[:, 0]), 1, ""))
    )
    assert len(after) == 0
    assert after.refused == ()


def _without_a_column(message: PointCloud2) -> None:
    del message.fields[2]


def _with_another_column(message: PointCloud2) -> None:
    message.fields[0].name = "x"


def _with_another_type(message: PointCloud2) -> None:
    message.fields[0].datatype = 7


def _too_short(message: PointCloud2) -> None:
    message.data = message.data[:-1]


def _more_rows_announced(message: PointCloud2) -> None:
    message.width += 1


def _of_another_step(message: PointCloud2) -> None:
    message.point_step += 8


@pytest.mark.parametrize(
    ("spoil", "parts"),
    [
        (_without_a_column, ["columns are", "must be", "right_u", "same version"]),
        (_with_another_column, ["columns are ['x'", "left_u"]),
        (_with_another_type, ["columns are"]),
        (_of_another_step, ["columns are"]),
        (_too_short, ["bytes", "announced"]),
        (_more_rows_announced, ["bytes", "announced"]),
    ],
)
def test_a_table_of_another_make_is_refused(spoil: Any, parts: list[str]) -> None:
    message = correspondences_message(correspondences(), STAMP_NS, "eye")
    spoil(message)
    with pytest.raises(TableError) as error:
        correspondences_of(sent(message))
    for part in parts:
        assert part in str(error.value)


def test_rows_that_no_version_of_the_node_sends_are_refused() -> None:
    message = correspondences_message(correspondences(1), STAMP_NS, "eye")
    nan_in_match = sent(message)
    nan_in_match.data[:8] = array("B", np.array([np.nan]).tobytes())
    with pytest.raises(ArrayError, match="left_px holds nan"):
        correspondences_of(nan_in_match)
    message.data[message.point_step + 22 * 8] = 250  # after 22 numbers
    with pytest.raises(StereoPickError, match="unknown reason 250"):
        correspondences_of(sent(message))


def poses(count: int) -> ObjectPoses:
    half = RNG.normal(0, 1e-3, (count, 3, 3))
    return ObjectPoses(
        stamp_ns=STAMP_NS,
        xyz=RNG.uniform(-0.2, 1, (count, 3)),
        rotation=np.array([rotation(vector) for vector in RNG.normal(0, 1, (count, 3))]),
        size_m=RNG.uniform(0.01, 0.1, (count, 3)),
        kinds=("box", "", "cylinder", "sphere")[:count],
        covariance=half @ half.transpose(0, 2, 1),
        ray_gap=RNG.uniform(0, 0.01, count),
        left_px=RNG.uniform(0, 600, (count, 2)),
        right_px=RNG.uniform(0, 600, (count, 2)),
        tolerance_m=0.003,
    )


@pytest.mark.parametrize("count", [0, 1, 4])
def test_a_pose_array_has_every_object_in_order(count: int) -> None:
    before = poses(count)
    message = sent(pose_array_message(before, "left_eye"))
    assert (stamp_ns(message.header.stamp), message.header.frame_id) == (STAMP_NS, "left_eye")
    positions = [(pose.position.x, pose.position.y, pose.position.z) for pose in message.poses]
    assert np.array_equal(np.reshape(positions, (-1, 3)), before.xyz)
    for pose, turn in zip(message.poses, before.rotation):
        q = pose.orientation
        x_axis = (1 - 2 * (q.y**2 + q.z**2), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y))
        assert np.allclose(x_axis, turn[:, 0], atol=1e-9)


@pytest.mark.parametrize("count", [0, 3])
def test_the_objects_table_has_all_that_is_known(count: int) -> None:
    before = poses(count)
    message = sent(objects_message(before, "left_eye"))
    assert message.is_dense
    rows = table_of(message, OBJECT_ROW)
    assert len(rows) == count
    for index, row in enumerate(rows):
        assert [row[name] for name in "xyz"] == before.xyz[index].tolist()
        assert [[row[f"cov_{a}{b}"] for b in "xyz"] for a in "xyz"] == before.covariance[index].tolist()
        assert (row["length"], row["width"], row["height"]) == tuple(before.size_m[index])
        assert KINDS[row["kind"]] == before.kinds[index]
        assert (row["left_u"], row["left_v"]) == tuple(before.left_px[index])
        assert (row["right_u"], row["right_v"]) == tuple(before.right_px[index])
        assert (row["yaw"], row["ray_gap"]) == (before.heading_rad[index], before.ray_gap[index])
        assert row["confidence"] == within(before.covariance, before.tolerance_m)[index]


def test_markers_replace_those_of_the_pair_before() -> None:
    before = poses(2)
    markers = sent(markers_message(before, "left_eye")).markers
    assert markers[0].action == Marker.DELETEALL
    assert {(marker.ns, marker.id) for marker in markers[1:]} == {(n, i) for n in ("objects", "labels") for i in (0, 1)}
    for marker in markers[1:]:
        assert marker.header.frame_id == "left_eye"
        assert marker.action == Marker.ADD
        assert marker.color.a > 0
        assert marker.pose.position.x == before.xyz[marker.id, 0]
        if marker.type == Marker.CUBE:
            assert [marker.scale.x, marker.scale.y, marker.scale.z] == before.size_m[marker.id].tolist()
        else:
            assert f"{before.xyz[marker.id, 2] * 1000:.1f} mm" in marker.text
            assert f"confidence {before.confidence[marker.id]:.3f}" in marker.text
    assert [marker.action for marker in sent(markers_message(poses(0), "e")).markers] == [Marker.DELETEALL]


def test_a_table_says_where_a_value_is_missing() -> None:
    rows = np.zeros(2, np.dtype([("a", np.float64), ("b", np.uint8)], align=True))
    assert table_message(rows, 0, "").is_dense
    rows["a"][1] = np.nan
    assert not table_message(rows, 0, "").is_dense


def test_a_diagnostic_is_one_status_with_its_values() -> None:
    message = sent(diagnostics_message("stereo_pick: capture", Status(ERROR, "what is wrong", {"n": "3"}), STAMP_NS))
    (status,) = message.status
    assert (status.name, status.level, status.message) == ("stereo_pick: capture", ERROR, "what is wrong")
    assert [(value.key, value.value) for value in status.values] == [("n", "3")]
    assert stamp_ns(message.header.stamp) == STAMP_NS


@pytest.mark.parametrize("time_ns", [0, 1, 999_999_999, 10**9, STAMP_NS, (2**31 - 1) * 10**9])
def test_stamps_keep_every_nanosecond(time_ns: int) -> None:
    assert stamp_ns(time_message(time_ns)) == time_ns


def test_data_of_an_image_is_not_copied_on_reading() -> None:
    message = Image(width=4, height=2, step=4, encoding="mono8", data=bytes(8))
    view = pixels(buffer_of(message))
    message.data[5] = 77
    assert view[1, 1] == 77
