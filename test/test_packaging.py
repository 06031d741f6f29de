"""The package as ROS and pip see it: one name, one version, and everything installed where it is looked for."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from configparser import ConfigParser
from pathlib import Path
from xml.etree import ElementTree

import pytest

import stereo_pick

ROOT = Path(__file__).parents[1]
# catkin_pkg's own rule: on another address colcon silently takes the package for a plain Python one.
EMAIL = re.compile(r"[-\w%+]+(\.[-\w%+]+)*@[-a-zA-Z0-9%]+(\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", re.ASCII)
NODES = (
    "capture_node",
    "rectification_node",
    "correspondence_node",
    "triangulation_node",
    "stereo_pick_node",
    "calibration_node",
)


@pytest.fixture(scope="module")
def manifest() -> ElementTree.Element:
    return ElementTree.parse(ROOT / "package.xml").getroot()


@pytest.fixture(scope="module")
def setup_cfg() -> ConfigParser:
    config = ConfigParser(delimiters=("=",))
    config.read(ROOT / "setup.cfg", encoding="utf-8")
    return config


def test_package_xml_is_an_ament_python_package_of_format_3(manifest: ElementTree.Element) -> None:
    assert (manifest.tag, manifest.get("format")) == ("package", "3")
    assert manifest.findtext("export/build_type") == "ament_python"


def test_name_and_version_are_the_same_everywhere(manifest: ElementTree.Element) -> None:
    command = [sys.executable, "setup.py", "--name", "--version"]
    from_setup = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    released = re.findall(r"^(\d+\.\d+\.\d+) \(\d{4}-\d\d-\d\d\)\n-+$", (ROOT / "CHANGELOG.rst").read_text(), re.M)
    expected = [stereo_pick.__name__, stereo_pick.__version__]
    assert from_setup[-2:] == expected
    assert [manifest.findtext("name"), manifest.findtext("version")] == expected
    assert ["stereo_pick", released[0]] == expected


def test_maintainers_can_be_written_to(manifest: ElementTree.Element) -> None:
    addresses = [each.get("email", "") for each in manifest.iter("maintainer")]
    assert addresses
    assert [each for each in addresses if not EMAIL.fullmatch(each)] == []


def test_every_ros_package_that_is_imported_is_declared(manifest: ElementTree.Element) -> None:
    declared = {each.text for each in manifest.iter("depend")}
    sources = "\n".join(file.read_text(encoding="utf-8") for file in (ROOT / "stereo_pick").rglob("*.py"))
    imported = set(re.findall(r"^\s*(?:from|import) (rclpy|\w+_msgs|\w+_interfaces|std_srvs)\b", sources, re.M))
    assert imported <= declared


def test_every_folder_with_python_is_a_package() -> None:
    folders = {file.parent for file in (ROOT / "stereo_pick").rglob("*.py")}
    assert [folder for folder in folders if not (folder / "__init__.py").is_file()] == []


def test_every_executable_has_its_function(setup_cfg: ConfigParser) -> None:
    scripts = dict(_pairs(setup_cfg["options.entry_points"]["console_scripts"]))
    assert set(scripts) == {"stereo-pick", *NODES}
    for target in scripts.values():
        module, function = target.split(":")
        source = (ROOT / module.replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8")
        assert re.search(rf"^def {function}\(", source, re.M), target


def test_the_lock_has_every_dependency_and_no_address(setup_cfg: ConfigParser) -> None:
    lock = (ROOT / "requirements.lock").read_text()
    wanted = [setup_cfg["options"]["install_requires"], *setup_cfg["options.extras_require"].values()]
    names = {_normal(re.split(r"[\[<>=]", line)[0]) for text in wanted for line in text.strip().splitlines()}
    locked = {_normal(name) for name in re.findall(r"^([\w.-]+)==", lock, re.M)}
    assert names <= locked
    assert not re.search(r"://|^-|@ ", lock, re.M)


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_make_starts_its_commands_apart_from_the_ros_of_the_terminal() -> None:
    """The wheels have no other middleware than Fast DDS, and rcl ends the process where another one is asked for."""
    done = subprocess.run(["make", "-n", "demo"], cwd=ROOT, capture_output=True, text=True, check=True)
    (command,) = (line for line in done.stdout.splitlines() if line.endswith("stereo-pick demo --output demo_output"))
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH", "AMENT_PREFIX_PATH", "RMW_IMPLEMENTATION"):
        assert f" -u {name} " in command
        assert f" -u {name} " in (ROOT / "README.md").read_text(encoding="utf-8")


def test_colcon_builds_a_ros_package(tmp_path: Path) -> None:
    pytest.importorskip("colcon_ros", reason="colcon is not installed")
    _copy(tmp_path / "src")
    assert _colcon("list", cwd=tmp_path).split() == ["stereo_pick", "src/stereo_pick", "(ros.ament_python)"]
    _colcon("build", cwd=tmp_path)

    install = tmp_path / "install/stereo_pick"
    share = install / "share/stereo_pick"
    assert sorted(file.name for file in (install / "lib/stereo_pick").iterdir()) == sorted(["stereo-pick", *NODES])
    assert (install / "share/ament_index/resource_index/packages/stereo_pick").is_file()
    for file in (ROOT / "package.xml", *ROOT.glob("launch/*.launch.py"), *ROOT.glob("config/**/*.yaml")):
        assert (share / file.relative_to(ROOT)).read_bytes() == file.read_bytes()
    installed = next(install.rglob("stereo_pick/py.typed")).parent
    for pattern in ("*.py", "*.xml"):
        files = {file.relative_to(ROOT / "stereo_pick") for file in (ROOT / "stereo_pick").rglob(pattern)}
        assert files == {file.relative_to(installed) for file in installed.rglob(pattern)}


def _copy(workspace: Path) -> None:
    ignore = shutil.ignore_patterns(".*", "__pycache__", "*.egg-info", "build", "install", "log", "bags", "demo_output")
    shutil.copytree(ROOT, workspace / "stereo_pick", ignore=ignore)


def _colcon(verb: str, cwd: Path) -> str:
    command = [sys.executable, "-m", "colcon", "--log-base", str(cwd / "log"), verb]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _pairs(text: str) -> Iterator[tuple[str, str]]:
    for line in text.strip().splitlines():
        name, _, target = line.partition("=")
        yield name.strip(), target.strip()


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
