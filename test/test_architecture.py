"""The import rule: core knows no other part and no ROS, and every part knows only what lies below it."""

from __future__ import annotations

import ast
import shutil
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import pytest

PACKAGE = Path(__file__).parents[1] / "stereo_pick"

# What each part of the package may import of the others.
PARTS = {
    "core": {"core"},
    "sources": {"core", "sources"},
    "ros": {"core", "sources", "ros"},
    "cli": {"core", "sources", "ros", "cli"},
}

# The modules and subpackages of core, each importing only what stands before it.
CORE_LAYERS = (
    "errors",
    "drafts",
    "arrays",
    "sampling",
    "noise",
    "params",
    "parameter_groups",
    "refusal",
    "transform",
    "rays",
    "camera",
    "lens",
    "sensor_window",
    "rectified_view",
    "rig",
    "calibration",
    "hand_eye",
    "images",
    "pairing",
    "hanging",
    "frames",
    "rectification",
    "calibration_page",
    "calibration_run",
    "objects",
    "shapes",
    "edges",
    "measured_table",
    "windows",
    "matches",
    "places",
    "tables",
    "doubts",
    "found_late",
    "correspondence",
    "triangulation",
    "confidence",
    "poses",
    "positioning",
    "annotation",
    "depth_report",
    "pipeline",
    "learned_parts",
    "configuration",
)
CORE_LIBRARIES = sys.stdlib_module_names | {"cv2", "numpy", "yaml"}


class Import(NamedTuple):
    """One import: file and line, and the dotted names of the module that imports and of what it imports."""

    where: str
    importer: str
    target: str


def violations(package: Path) -> list[str]:
    """What breaks the import rule in the package at this folder, each with its file and line."""
    modules = {_module(package, file): file for file in sorted(package.rglob("*.py"))}
    imports = list(_imports(package, modules))
    found = [_misplaced(module, file.relative_to(package.parent)) for module, file in modules.items()]
    found += [_forbidden(each) for each in imports]
    return [text for text in found if text] + _core_cycles(package.name, imports)


def _misplaced(module: str, file: Path) -> str | None:
    _, part, layer = _names(module)
    if part and part not in PARTS:
        return f"{file}: {part} is no part of the package that PARTS knows"
    if part == "core" and layer and layer not in CORE_LAYERS:
        return f"{file}: {layer} has no place in CORE_LAYERS"
    return None


def _forbidden(each: Import) -> str | None:
    package, part, layer = _names(each.importer)
    library, other, below = _names(each.target)
    if library != package:
        outside = part == "core" and library not in CORE_LIBRARIES
        return f"{each.where}: core imports {each.target}" if outside else None
    if part in PARTS and other in PARTS and other not in PARTS[part]:
        return f"{each.where}: {part} imports {each.target}"
    if part == other == "core" and _rank(below) > _rank(layer):
        return f"{each.where}: {layer or 'core itself'} lies below {each.target}, which it imports"
    return None


def _names(module: str) -> tuple[str, str, str]:
    """The package, the part and the layer of a dotted name, each empty where the name is shorter."""
    package, part, layer, *_ = [*module.split("."), "", ""]
    return package, part, layer


def _rank(layer: str) -> int:
    """Height of a layer; core's own __init__ is the lowest, since every module of core runs it first."""
    heights = {"": -1} | {name: height for height, name in enumerate(CORE_LAYERS)}
    return heights.get(layer, len(CORE_LAYERS))


def _core_cycles(package: str, imports: list[Import]) -> list[str]:
    """The first cycle among the modules of core, as text."""
    graph: dict[str, set[str]] = {}
    for each in imports:
        if each.target.startswith(f"{package}.core.") and each.importer.startswith(f"{package}.core."):
            graph.setdefault(each.importer, set()).add(each.target)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return ["core imports in a circle: " + " -> ".join(reversed(error.args[1]))]
    return []


def _imports(package: Path, modules: dict[str, Path]) -> Iterator[Import]:
    """Every import in the package, wherever it stands in a file; `from a import b` is a.b where that is a module."""
    for importer, file in modules.items():
        for node in _import_nodes(file.read_text(encoding="utf-8")):
            where = f"{file.relative_to(package.parent)}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.Import):
                yield from (Import(where, importer, alias.name) for alias in node.names)
            else:
                base = _absolute(node, importer, is_package=file.name == "__init__.py")
                for alias in node.names:
                    deeper = f"{base}.{alias.name}"
                    is_module = deeper in modules or (base == package.name and alias.name in PARTS)
                    yield Import(where, importer, deeper if is_module else base)


@cache
def _import_nodes(source: str) -> list[ast.Import | ast.ImportFrom]:
    return [node for node in ast.walk(ast.parse(source)) if isinstance(node, (ast.Import, ast.ImportFrom))]


def _module(package: Path, file: Path) -> str:
    parts = file.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _absolute(node: ast.ImportFrom, importer: str, *, is_package: bool) -> str:
    if not node.level:
        return node.module or ""
    base = importer.split(".")
    base = base[: len(base) - node.level + is_package]
    return ".".join([*base, node.module] if node.module else base)


def test_the_package_keeps_the_import_rule() -> None:
    assert violations(PACKAGE) == []


@pytest.mark.parametrize(
    ("file", "offence", "complaint"),
    [
        ("core/errors.py", "import rclpy", "core imports rclpy"),
        ("core/errors.py", "import rclpy.node as node", "core imports rclpy.node"),
        ("core/errors.py", "def late():\n    import rclpy", "core imports rclpy"),
        ("core/errors.py", "try:\n    import rosbags\nexcept ImportError:\n    pass", "core imports rosbags"),
        ("core/errors.py", "from mcap.reader import make_reader", "core imports mcap.reader"),
        ("core/camera.py", "from sensor_msgs.msg import CameraInfo", "core imports sensor_msgs.msg"),
        ("core/camera.py", "import stereo_pick.sources", "core imports stereo_pick.sources"),
        ("core/camera.py", "from stereo_pick import ros", "core imports stereo_pick.ros"),
        ("core/camera.py", "from ..cli import main", "core imports stereo_pick.cli"),
        ("core/calibration/files.py", "from ...ros.topics import LEFT", "core imports stereo_pick.ros.topics"),
        ("core/arrays.py", "from stereo_pick.core.rig import StereoRig", "arrays lies below stereo_pick.core.rig"),
        ("core/arrays.py", "from stereo_pick.core import rig", "arrays lies below stereo_pick.core.rig"),
        ("core/arrays.py", "from .rig import StereoRig", "arrays lies below stereo_pick.core.rig"),
        ("core/__init__.py", "from .rig import StereoRig", "core itself lies below stereo_pick.core.rig"),
        ("core/novelty.py", "import math", "novelty has no place in CORE_LAYERS"),
        ("core/novelty.py", "", "novelty has no place in CORE_LAYERS"),
        ("core/calibration/a.py", "from . import b", "core imports in a circle"),
        ("sources/live.py", "from stereo_pick.ros import messages", "sources imports stereo_pick.ros"),
        ("sources/live.py", "from stereo_pick.cli.main import main", "sources imports stereo_pick.cli.main"),
        ("ros/shell.py", "import stereo_pick.cli.main", "ros imports stereo_pick.cli.main"),
        ("gui/window.py", "import math", "gui is no part"),
    ],
)
def test_an_offence_is_seen(file: str, offence: str, complaint: str, tmp_path: Path) -> None:
    package = _copy(tmp_path)
    _append(package / "core/calibration/b.py", "from . import a" if file.endswith("a.py") else "")
    _append(package / file, offence)
    found = violations(package)
    assert any(f"stereo_pick/{file}:" in text or "circle" in text for text in found), found
    assert any(complaint in text for text in found), found


def test_what_the_rule_allows_is_not_seen(tmp_path: Path) -> None:
    package = _copy(tmp_path)
    before = violations(package)
    allowed = {
        "core/rig.py": "import json, cv2\nfrom .arrays import floats\nfrom stereo_pick import core",
        "core/calibration/b.py": "from stereo_pick.core.calibration import files",
        "sources/live.py": "import rosbags\nfrom . import bag\nfrom stereo_pick.core.rig import StereoRig",
        "ros/shell.py": "import rclpy\nfrom stereo_pick import __version__, core, sources",
        "cli/extra.py": "from stereo_pick import core, ros, sources\nfrom stereo_pick.cli import main",
    }
    for file, source in allowed.items():
        _append(package / file, source)
    assert violations(package) == before


def _copy(tmp_path: Path) -> Path:
    return Path(shutil.copytree(PACKAGE, tmp_path / "stereo_pick", ignore=shutil.ignore_patterns("__pycache__")))


def _append(file: Path, source: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    before = file.read_text(encoding="utf-8") if file.exists() else ""
    file.write_text(f"{before}\n{source}\n", encoding="utf-8")
