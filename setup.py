"""Installs launch and configuration files where ROS looks for them; setup.cfg declares the rest."""

from pathlib import Path

from setuptools import setup


def shared(pattern: str) -> list[tuple[str, list[str]]]:
    """Every file of `pattern`, into the same folder under share/stereo_pick."""
    files = sorted(path for path in Path().glob(pattern) if path.is_file())
    return [(str("share/stereo_pick" / path.parent), [str(path)]) for path in files]


setup(
    python_requires=">=3.10",  # stands here because colcon cannot read it out of setup.cfg
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/stereo_pick"]),
        *shared("package.xml"),
        *shared("launch/*.launch.py"),
        *shared("config/**/*"),
        *shared("bags/**/*"),
    ],
)
