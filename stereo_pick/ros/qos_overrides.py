"""Overrides of a quality of service that change nothing: ROS passes over them without a word."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches

from rclpy.node import Node

from stereo_pick.ros.node import OVERRIDABLE
from stereo_pick.ros.parameters import given_values
from stereo_pick.ros.topics import TOPICS

_ENDS = ("publisher", "subscription")
_POLICIES = [policy.name.lower() for policy in OVERRIDABLE]


def warn_of_vain_overrides(nodes: Sequence[Node]) -> None:
    """Log each override that was given to the nodes at their start, and is of no topic, end or policy of the package.

    A file may be shared: those of the package's other nodes are fine, and so are those of a topic's other names beside
    the one that it has here.
    """
    said: dict[str, Node] = {}
    for node in nodes:
        given = {name: value for name, value in given_values(node).items() if name.split(".")[0] == "qos_overrides"}
        named = {name.split(".")[1] for name in given if "." in name}
        resolved = {topic.name: node.resolve_topic_name(topic.name) for topic in TOPICS}
        said |= {fault: node for name, value in given.items() if (fault := _fault(name, value, named, resolved))}
    for fault, node in said.items():
        node.get_logger().warning(fault)


def _fault(name: str, value: object, named: Collection[str], resolved: Mapping[str, str]) -> str:
    """Why an override changes nothing; empty where it may change something.

    named: the topics of all overrides; resolved: of the package's topics, the names that they have here.
    """
    vain, parts = f"{name} = {value!r} changes nothing", name.split(".")[1:]
    if len(parts) != 3:
        return f"{vain}: give it as qos_overrides.<topic>.publisher|subscription.<policy> (docs/nodes.md)"
    topic, end, policy = parts
    if topic not in resolved.values():
        return _topic_fault(topic, named, resolved)
    if end not in _ENDS:
        return f"{vain}: {end!r} must be one of: {', '.join(_ENDS)}"
    if policy not in _POLICIES:
        return f"{vain}: {policy!r} must be one of: {', '.join(_POLICIES)}"
    return ""


def _topic_fault(topic: str, named: Collection[str], resolved: Mapping[str, str]) -> str:
    vain = f"qos_overrides.{topic} changes nothing"
    same = [name for name in resolved if f"/{topic}".endswith(f"/{name.removeprefix('/')}")]
    if same:
        here = resolved[max(same, key=len)]
        return "" if here in named else f"{vain}: with namespace and remappings the topic is {here} here: name that"
    near = get_close_matches(topic, resolved.values(), n=1)
    hint = f"did you mean {near[0]}?" if near else "docs/nodes.md lists them all"
    return f"{vain}: there is no such topic; {hint}"
