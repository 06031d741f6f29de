"""Parameters that were given and that no node has: ROS passes over them without a word."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.node import Node

from stereo_pick.core.params import unknown_name
from stereo_pick.ros.parameters import given_values

_OF_ROS = "qos_overrides"  # named after topics: qos_overrides.py


def warn_of_misspelled(nodes: Sequence[Node]) -> None:
    """Log each parameter that was given to the nodes at their start, and that no node of this package has."""
    given = {name: node for node in nodes for name in given_values(node) if name.split(".")[0] != _OF_ROS}
    unknown = {name: node for name, node in given.items() if not any(each.has_parameter(name) for each in nodes)}
    if not unknown:
        return
    from stereo_pick.ros.all_parameters import all_parameters  # imports the nodes, which import this

    known = {name for parameters in all_parameters().values() for name in parameters}
    for name, node in unknown.items():
        if name not in known:
            node.get_logger().warning(unknown_name(name, known))
