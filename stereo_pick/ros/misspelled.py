"""Parameters that were given and that no node has: ROS passes over them without a word."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.node import Node

from stereo_pick.core.params import unknown_name

_OF_ROS = "qos_overrides."  # named after topics; a node that shares a file with others is given theirs, too


def warn_of_misspelled(nodes: Sequence[Node]) -> None:
    """Log each parameter that was given to the nodes at their start, and that no node of this package has."""
    given = {name: node for node in nodes for name in _given(node) if not name.startswith(_OF_ROS)}
    unknown = {name: node for name, node in given.items() if not any(each.has_parameter(name) for each in nodes)}
    if not unknown:
        return
    from stereo_pick.ros.all_parameters import all_parameters  # imports the nodes, which import this

    known = {name for parameters in all_parameters().values() for name in parameters}
    for name, node in unknown.items():
        if name not in known:
            node.get_logger().warning(unknown_name(name, known))


def _given(node: Node) -> list[str]:
    """Names of the values from the command line and from files; rclpy has no public way to ask for them."""
    return list(getattr(node, "_parameter_overrides", {}))
