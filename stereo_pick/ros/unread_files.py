"""Parameter files without a section, or with one that was meant for a node but is not: ROS says nothing of them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path
from typing import Any

import yaml
from rclpy.node import Node

_VALUES = "ros__parameters"
_NEAR = 0.8  # difflib's similarity of a name that is misspelled


def warn_of_unread(nodes: Sequence[Node], args: Sequence[str]) -> None:
    """Log each file of the command line `args` that ROS has read, but for another name than that of a node, or none."""
    for path in [Path(value) for option, value in pairwise(args) if option == "--params-file"]:
        sections = _sections(path)
        if not sections:
            nodes[0].get_logger().warning(
                f"{path} has no parameters in it: they stand below the name of a node and {_VALUES}, as in "
                f"/**/{nodes[0].get_name()}: {{{_VALUES}: {{name: value}}}}"
            )
        for node in nodes:
            own = node.get_fully_qualified_name()
            meant = None if any(is_for(section, own) for section in sections) else _meant(node.get_name(), sections)
            if meant is not None:
                node.get_logger().warning(
                    f"{path} has nothing for the node {own}: if its section {meant} is meant, name that {own}, or "
                    f"/**/{node.get_name()} for all namespaces"
                )


def is_for(section: str, node: str) -> bool:
    """Whether ROS takes a section for a node, both by their full names; ** stands for any namespaces, * for one."""
    parts = section.removeprefix("/").split("/")
    pattern = "".join("(/[^/]+)*" if part == "**" else "/" + re.escape(part).replace(r"\*", "[^/]+") for part in parts)
    return re.fullmatch(pattern, node) is not None


def _sections(path: Path) -> list[str]:
    """The names of the nodes, with their namespaces, that a file is for."""
    contents = yaml.load_all(path.read_bytes(), yaml.BaseLoader)  # as ROS does: all documents, whatever tags they have
    return [name for content in contents if isinstance(content, Mapping) for name in _named("", content)]


def _named(name: str, content: Mapping[Any, Any]) -> Iterator[str]:
    for key, value in content.items():
        if key == _VALUES:
            yield name
        elif isinstance(value, Mapping):
            yield from _named(f"{name}/{str(key).removeprefix('/')}", value)


def _meant(node: str, sections: Sequence[str]) -> str | None:
    """The section whose name, without its namespace, is most like this node's; None where it is another node's."""
    from stereo_pick.ros.all_parameters import all_parameters  # imports the nodes, which import this

    others = all_parameters().keys() - {node}
    named = {section.rpartition("/")[2]: section for section in sections}
    near = get_close_matches(node, named.keys() - others, n=1, cutoff=_NEAR)
    return named[near[0]] if near else None
