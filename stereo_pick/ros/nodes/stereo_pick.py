"""All four nodes in one process; parameters, topics and messages are those of the single nodes."""

from __future__ import annotations

import sys

from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.nodes.correspondence import CorrespondenceNode
from stereo_pick.ros.nodes.rectification import RectificationNode
from stereo_pick.ros.nodes.triangulation import TriangulationNode
from stereo_pick.ros.process import run_nodes


def main(args: list[str] | None = None) -> int:
    """Run the four nodes."""
    return run_nodes([TriangulationNode, CorrespondenceNode, RectificationNode, CaptureNode], args)


if __name__ == "__main__":
    sys.exit(main())
