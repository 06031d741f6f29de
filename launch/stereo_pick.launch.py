"""The four nodes, on a recording or beside a camera driver.

ros2 launch stereo_pick stereo_pick.launch.py source:=my_bag calibration:=my_rig method:=feature
ros2 launch stereo_pick stereo_pick.launch.py            # cameras publish left|right/image_raw and camera_info
"""

from collections.abc import Callable
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = {
    "source": ("", "a bag or a folder of image pairs to replay; empty starts no capture node: a driver publishes"),
    "calibration": (
        "",
        "folder with left.yaml and right.yaml; empty takes that of params_file, or the bag's. Without a source, only "
        "the calibration.yaml in it is read",
    ),
    "calibration_file": ("", "calibration.yaml with uncertainties; empty takes that of the folder `calibration`"),
    "hand_eye_file": ("", "file of stereo-pick hand-eye; poses are then in the robot's frame"),
    "method": ("", "how objects are found again in the right view: feature or ssd; empty takes that of params_file"),
    "params_file": (
        PathJoinSubstitution([FindPackageShare("stereo_pick"), "config", "stereo_pick.yaml"]),
        "parameters of all nodes",
    ),
    "rate": ("", "speed of the replay; empty takes that of params_file"),
    "loop": ("", "true starts the recording over at its end; empty takes that of params_file"),
    "use_sim_time": ("", "true takes the time from /clock, which the capture node publishes"),
    "namespace": ("", "namespace of all nodes and topics"),
    "one_process": ("false", "all four nodes in one process; needs a source"),
}


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the nodes."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_nodes)])


def _record_of(calibration: str) -> str:
    path = Path(calibration).expanduser() / "calibration.yaml"
    return str(path) if calibration and path.is_file() else ""


def _is_true(text: str) -> bool:
    if text.lower() not in ("true", "false"):
        raise ValueError(f"{text!r} must be true or false")
    return text.lower() == "true"


def _typed(name: str, text: str, kind: Callable[[str], object]) -> object:
    try:
        return kind(text)
    except ValueError as error:
        raise ValueError(f"{name}:={text} of the launch file: {error}") from None


def _check_used(value: dict[str, str], record: str) -> None:
    """Raise ValueError for what the capture node alone reads, where none is started.

    record: the calibration.yaml that is found in the folder `calibration`, which triangulation reads without it, too.
    """
    unused = [f"{name}:={value[name]}" for name in ("rate", "loop") if value[name]]
    if value["calibration"] and (value["calibration_file"] or not record):
        unused.append(f"calibration:={value['calibration']}")
    if unused and not value["source"]:
        raise ValueError(
            f"{' '.join(unused)} of the launch file would change nothing without a source: give source:=..., or leave "
            "it out, as the camera drivers publish images and camera_info of their own"
        )


def _nodes(context) -> list[Node]:
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}

    def given(**kinds: Callable[[str], object]) -> dict[str, object]:
        """What is not empty, as that would win over params_file; typed, as doubles refuse an integer."""
        return {name: _typed(name, value[name], kind) for name, kind in kinds.items() if value[name]}

    common = given(use_sim_time=_is_true)
    capture = given(source=str, calibration=str, rate=float, loop=_is_true)
    correspondence = given(method=str)

    record, one_process = _record_of(value["calibration"]), bool(given(one_process=_is_true).get("one_process"))
    if not one_process:
        _check_used(value, record)
    value["calibration_file"] = value["calibration_file"] or record
    triangulation = given(calibration_file=str, hand_eye_file=str)

    def node(name: str, **parameters: object) -> Node:
        return Node(
            package="stereo_pick",
            executable=f"{name}_node",
            namespace=value["namespace"],
            name=None if name == "stereo_pick" else name,
            output="screen",
            parameters=[value["params_file"], *([own] if (own := {**common, **parameters}) else [])],
        )

    if one_process:
        return [node("stereo_pick", **capture, **correspondence, **triangulation)]
    nodes = [node("triangulation", **triangulation), node("correspondence", **correspondence), node("rectification")]
    return [*nodes, node("capture", **capture)] if value["source"] else nodes
