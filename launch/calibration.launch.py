"""The calibration node, beside two camera drivers.

ros2 launch stereo_pick calibration.launch.py board:=charuco:11x8:0.75:5X5_100 square_m:=0.020 output:=my_rig
        left:=/cam_a/image_raw right:=/cam_b/image_raw
ros2 service call /calibration/finish std_srvs/srv/Trigger
ros2 service call /calibration/save std_srvs/srv/Trigger
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    "board": ("", "chessboard:9x6 (inner corners) or charuco:11x8:0.75:5X5_100 (squares)"),
    "square_m": ("0.0", "side of one square, measured on the board"),
    "output": ("", "folder that the service save writes to"),
    "baseline_m": ("0.0", "distance of the two lenses, measured with a ruler; 0 where it was not"),
    "max_stamp_offset_s": ("0.01", "by how much the stamps of a left and a right image may differ"),
    "left": ("left/image_raw", "topic of the left camera's raw images"),
    "right": ("right/image_raw", "topic of the right camera's raw images"),
    "namespace": ("", "namespace of the node and its topics"),
}


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the node."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_nodes)])


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ValueError(f"{name}:={text} of the launch file: {error}: give metres or seconds, as 0.020") from None


def _nodes(context) -> list[Node]:
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    # Typed here: on the command line 1 would become an integer, which a parameter of type double refuses.
    numbers = {name: _number(name, value[name]) for name in ("square_m", "baseline_m", "max_stamp_offset_s")}
    return [
        Node(
            package="stereo_pick",
            executable="calibration_node",
            namespace=value["namespace"],
            name="calibration",
            output="screen",
            parameters=[{"board": value["board"], "output": value["output"], **numbers}],
            remappings=[("left/image_raw", value["left"]), ("right/image_raw", value["right"])],
        )
    ]
