"""The table of the README: four parts of known size on a table, rendered, located with default parameters.

python benchmark/readme_example.py
"""

from __future__ import annotations

from rendering import Box, Cylinder, Scene, Sphere, render
from rendering.rigs import BENCH_RIGS, table_before

from stereo_pick.cli.report import pose_table
from stereo_pick.core.pipeline import Pipeline, Steps

_PARTS = (
    Cylinder(-0.08, 0.0, (0.04, 0.04, 0.05)),
    Box(0.0, 0.02, (0.05, 0.036, 0.04), yaw_rad=0.5),
    Sphere(0.07, 0.0, (0.04, 0.04, 0.04)),
    Cylinder(0.0, -0.06, (0.03, 0.03, 0.07), yaw_rad=0.3, lying=True),
)


def main() -> None:
    """Render, locate, print."""
    rig = BENCH_RIGS["thesis"]
    scene = Scene(_PARTS, table_before(rig, distance_m=0.9, elevation_deg=50.0), ambient=0.7)
    print(pose_table(Pipeline(rig, Steps()).run(render(rig, scene)).poses))


if __name__ == "__main__":
    main()
