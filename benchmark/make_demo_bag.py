"""Makes bags/demo from the rendered conveyor sequence: raw mono images, camera_info, and the exact truth.

python benchmark/make_demo_bag.py DATA/bench_rig
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import cv2
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from stereo_pick.core.calibration.files import load_rig, save_rig
from stereo_pick.core.rig import StereoRig

ROOT = Path(__file__).resolve().parents[1]
START_NS = 1_760_000_000 * 1_000_000_000
TYPES = get_typestore(Stores.ROS2_JAZZY)
SIDES = ("left", "right")


def main(bench_rig: Path) -> None:
    """Write the bag, its truth and its calibration."""
    rig = load_rig(bench_rig / "calibration" / "truth")
    frames = sorted((bench_rig / "sequence").glob("frame_*"))
    bag = ROOT / "bags" / "demo"
    shutil.rmtree(bag, ignore_errors=True)
    truth = []
    writer = Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connections = _connections(writer)
        for folder in frames:
            scene = json.loads((folder / "truth.json").read_text())
            stamp_ns = START_NS + round(scene["scene"]["time_s"] * 1e9)
            _write_pair(writer, connections, folder, rig, stamp_ns)
            truth.append({"stamp_ns": stamp_ns, "objects": [_truth(shape) for shape in scene["objects"]]})
    (ROOT / "bags" / "demo_truth.json").write_text(json.dumps({"frames": truth}, indent=1) + "\n")
    save_rig(rig, ROOT / "config" / "demo_rig")


def _connections(writer: Writer) -> dict[str, Any]:
    kinds = {"image_raw": "sensor_msgs/msg/Image", "camera_info": "sensor_msgs/msg/CameraInfo"}
    return {
        f"{side}/{name}": writer.add_connection(f"/{side}/{name}", kind, typestore=TYPES)
        for side in SIDES
        for name, kind in kinds.items()
    }


def _write_pair(writer: Writer, connections: dict[str, Any], folder: Path, rig: StereoRig, stamp_ns: int) -> None:
    for side in SIDES:
        image = cv2.imread(str(folder / f"{side}.png"), cv2.IMREAD_GRAYSCALE)
        header = _message(
            "std_msgs/msg/Header",
            stamp=_message("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9),
            frame_id=f"{side}_camera_optical_frame",
        )
        height, width = image.shape
        raw = _message(
            "sensor_msgs/msg/Image",
            header=header, height=height, width=width, encoding="mono8", is_bigendian=0, step=width,
            data=image.ravel(),
        )  # fmt: skip
        for name, message in (("camera_info", _camera_info(rig, side, header)), ("image_raw", raw)):
            connection = connections[f"{side}/{name}"]
            writer.write(connection, stamp_ns, TYPES.serialize_cdr(message, connection.msgtype))


def _camera_info(rig: StereoRig, side: str, header: Any) -> Any:
    camera = rig.left if side == "left" else rig.right
    region = _message("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    return _message(
        "sensor_msgs/msg/CameraInfo",
        header=header, height=camera.height_px, width=camera.width_px, distortion_model=camera.distortion_model,
        d=camera.D, k=camera.K.ravel(), r=camera.R.ravel(), p=camera.P.ravel(), binning_x=0, binning_y=0, roi=region,
    )  # fmt: skip


def _message(kind: str, **fields: Any) -> Any:
    return TYPES.types[kind](**fields)


def _truth(shape: dict[str, Any]) -> dict[str, Any]:
    return {"name": shape["name"], "position_m": [value / 1000 for value in shape["volumetric_centroid"]]}


if __name__ == "__main__":
    main(Path(sys.argv[1]))
