"""The four nodes, on a recording or beside a camera driver.

ros2 launch stereo_pick stereo_pick.launch.py source:=my_bag calibration:=my_rig method:=feature
ros2 launch stereo_pick stereo_pick.launch.py            # cameras publish left|right/image_raw and camera_info
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = {
    "source": ("", "a bag or a folder of image pairs to replay; empty starts no capture node: a driver publishes"),
    "calibration": ("", "folder with left.yaml and right.yaml; empty takes the bag's camera_info"),
    "calibration_file": ("", "calibration.yaml with uncertainties; empty takes that of the folder `calibration`"),
    "hand_eye_file": ("", "file of stereo-pick hand-eye; poses are then in the robot's frame"),
    "method": ("feature", "how objects are found again in the right view: feature or ssd"),
    "params_file": (
        PathJoinSubstitution([FindPackageShare("stereo_pick"), "config", "stereo_pick.yaml"]),
        "parameters of all nodes",
    ),
    "rate": ("1.0", "speed of the replay"),
    "loop": ("false", "start the recording over at its end"),
    "use_sim_time": ("false", "take the time from /clock, which the capture node publishes"),
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
    path = Path(calibration) / "calibration.yaml"
    return str(path) if calibration and path.is_file() else ""


def _nodes(context) -> list[Node]:
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    common = {"use_sim_time": value["use_sim_time"] == "true"}
    # Typed here: on the command line 1 would become an integer, which a parameter of type double refuses.
    capture = {"rate": float(value["rate"]), "loop": value["loop"] == "true"}
    capture |= {name: value[name] for name in ("source", "calibration")}
    correspondence = {"method": value["method"]}

    record = value["calibration_file"] or _record_of(value["calibration"])
    files = {"calibration_file": record, "hand_eye_file": value["hand_eye_file"]}
    triangulation = {name: path for name, path in files.items() if path}

    def node(name: str, **parameters: object) -> Node:
        return Node(
            package="stereo_pick",
            executable=f"{name}_node",
            namespace=value["namespace"],
            name=None if name == "stereo_pick" else name,
            output="screen",
            parameters=[value["params_file"], {**common, **parameters}],
        )

    if value["one_process"] == "true":
        return [node("stereo_pick", **capture, **correspondence, **triangulation)]
    nodes = [node("triangulation", **triangulation), node("correspondence", **correspondence), node("rectification")]
    return [*nodes, node("capture", **capture)] if value["source"] else nodes
