"""The launch files: read everywhere, really launched where ROS's launch is installed."""

from __future__ import annotations

import ast
import importlib.util
import runpy
import shutil
import signal
import sys
from configparser import ConfigParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from recordings import DEMO_BAG
from ros_tools import ROOT, System

from stereo_pick.ros import executables
from stereo_pick.ros.topics import IMAGE_RAW, OBJECT_POSES

LAUNCH = ROOT / "launch" / "stereo_pick.launch.py"
TREE = ast.parse(LAUNCH.read_text())
CALIBRATION = ast.parse((ROOT / "launch" / "calibration.launch.py").read_text())


def _strings() -> set[str]:
    return {node.value for node in ast.walk(TREE) if isinstance(node, ast.Constant) and isinstance(node.value, str)}


def _arguments(tree: ast.Module = TREE) -> dict[str, ast.expr]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and any(isinstance(t, ast.Name) and t.id == "ARGUMENTS" for t in node.targets):
            assert isinstance(node.value, ast.Dict)
            return {str(ast.literal_eval(key)): value for key, value in zip(node.value.keys, node.value.values) if key}
    raise AssertionError("no ARGUMENTS")


@pytest.mark.parametrize("tree", [TREE, CALIBRATION], ids=["stereo_pick", "calibration"])
def test_it_generates_a_launch_description(tree: ast.Module) -> None:
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert functions["generate_launch_description"].args.args == []


def test_every_argument_has_a_default_and_says_what_it_is_for() -> None:
    arguments = _arguments()
    assert {"source", "calibration", "method", "rate", "loop", "use_sim_time", "one_process"} <= set(arguments)
    for name, value in [*arguments.items(), *_arguments(CALIBRATION).items()]:
        assert isinstance(value, ast.Tuple), name
        assert len(ast.literal_eval(value.elts[1])) > 10, name


def test_every_node_that_it_starts_is_installed() -> None:
    config = ConfigParser(delimiters=("=",))
    config.read(ROOT / "setup.cfg", encoding="utf-8")
    installed = config["options.entry_points"]["console_scripts"]
    for name in ("capture", "rectification", "correspondence", "triangulation", "stereo_pick", "calibration"):
        assert name in _strings() or name == "calibration"
        assert f"{name}_node = stereo_pick.ros.executables:{name}" in installed
        assert callable(getattr(executables, name))
        assert (ROOT / "stereo_pick" / "ros" / "nodes" / f"{name}.py").is_file()
    assert {"stereo_pick.yaml", "config"} <= _strings()
    assert (ROOT / "config" / "stereo_pick.yaml").is_file()


def _launched(monkeypatch: pytest.MonkeyPatch, file: Path = LAUNCH, **arguments: str) -> dict[str, dict[str, object]]:
    """By executable what its node is given beyond params_file, by as much of ROS's launch as the file needs."""

    class Stub:
        def __init__(self, *args: Any, **more: Any) -> None:
            self.args, self.more = args, more

        def perform(self, context: dict[str, str]) -> str:
            return context[self.args[0]]

    tree = ast.parse(file.read_text())
    names = [node.names for node in tree.body if isinstance(node, ast.ImportFrom) and "launch" in str(node.module)]
    content = dict.fromkeys((name.name for each in names for name in each), Stub)
    for module in (
        "launch",
        "launch.actions",
        "launch.substitutions",
        "launch_ros.actions",
        "launch_ros.substitutions",
    ):
        monkeypatch.setitem(sys.modules, module, SimpleNamespace(**content))
    launch = runpy.run_path(str(file))
    context = {name: default for name, (default, _) in launch["ARGUMENTS"].items()} | arguments
    nodes = [node.more for node in launch["_nodes"](context)]
    own = {node["executable"]: [each for each in node["parameters"] if isinstance(each, dict)] for node in nodes}
    return {name: {k: v for each in parameters for k, v in each.items()} for name, parameters in own.items()}


def test_what_is_not_given_is_left_to_params_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """A default that is given on would win over it: method, rate and loop of a params_file changed nothing."""
    assert not any(_launched(monkeypatch).values())
    assert _launched(monkeypatch, source="my_bag")["capture_node"] == {"source": "my_bag"}
    nodes = _launched(monkeypatch, source="my_bag", rate="1", loop="True", method="ssd", use_sim_time="true")
    assert nodes["capture_node"] == {"source": "my_bag", "rate": 1.0, "loop": True, "use_sim_time": True}
    assert nodes["correspondence_node"] == {"method": "ssd", "use_sim_time": True}
    assert list(_launched(monkeypatch, source="my_bag", one_process="True")) == ["stereo_pick_node"]
    with pytest.raises(ValueError, match="loop:=yes of the launch file: 'yes' must be true or false"):
        _launched(monkeypatch, source="my_bag", loop="yes")
    with pytest.raises(ValueError, match="rate:=fast of the launch file: "):
        _launched(monkeypatch, source="my_bag", rate="fast")


@pytest.mark.parametrize("unused", [{"calibration": "my_rig"}, {"rate": "0.5"}, {"loop": "true"}])
def test_what_is_of_no_use_without_a_source_is_said(unused: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    ((name, value),) = unused.items()
    with pytest.raises(ValueError, match=f"^{name}:={value} of the launch file would change nothing without a source"):
        _launched(monkeypatch, **unused)
    assert _launched(monkeypatch, source="my_bag", **unused)["capture_node"][name]
    assert _launched(monkeypatch, one_process="true", **unused)["stereo_pick_node"][name], "params_file may name one"


def test_beside_a_driver_a_calibration_gives_its_uncertainty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "calibration.yaml").touch()
    launched = _launched(monkeypatch, calibration=str(tmp_path))
    assert launched["triangulation_node"] == {"calibration_file": str(tmp_path / "calibration.yaml")}
    with pytest.raises(ValueError, match="^calibration:=.* would change nothing without a source"):
        _launched(monkeypatch, calibration=str(tmp_path), calibration_file="other.yaml")


def test_a_number_that_is_none_is_named_for_the_calibration_node(monkeypatch: pytest.MonkeyPatch) -> None:
    file = ROOT / "launch" / "calibration.launch.py"
    assert _launched(monkeypatch, file, board="9x6", square_m="1")["calibration_node"]["square_m"] == 1.0
    with pytest.raises(ValueError, match="square_m:=20mm of the launch file: .*'20mm': give metres or seconds"):
        _launched(monkeypatch, file, board="9x6", square_m="20mm")


def test_the_calibration_node_is_launched_with_its_own_defaults() -> None:
    from stereo_pick.cli.parameters import nodes

    declared, arguments = nodes()["calibration"], _arguments(CALIBRATION)
    for name in ("board", "square_m", "output", "baseline_m", "max_stamp_offset_s"):
        assert ast.literal_eval(arguments[name].elts[0]) == str(declared[name].default)  # type: ignore[attr-defined]
    strings = {node.value for node in ast.walk(CALIBRATION) if isinstance(node, ast.Constant)}
    assert {"calibration_node", "calibration", *(topic.name for topic in IMAGE_RAW.values())} <= strings


def test_it_really_launches_the_nodes(system: System) -> None:
    missing = [name for name in ("launch", "launch_ros") if importlib.util.find_spec(name) is None]
    if missing or shutil.which("ros2") is None:
        pytest.skip(f"not installed: {', '.join(missing) or 'the command ros2'}; pip has no wheels of them")
    child = system.start(
        "ros2", "launch", str(LAUNCH), f"source:={DEMO_BAG}", "loop:=true", "rate:=0.2", PYTHON=sys.executable
    )
    poses = system.graph.listen(OBJECT_POSES)
    system.graph.wait(lambda: any(message.poses for message in poses), "poses")
    child.end(signal.SIGINT)
