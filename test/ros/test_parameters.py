"""Parameters on real nodes: what they tell of themselves, what they refuse, and when they take effect."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
import yaml
from rcl_interfaces.msg import SetParametersResult
from rclpy.parameter import Parameter as RosParameter
from ros_tools import Graph, reserved_domain

from stereo_pick.cli.parameters import nodes as declared_nodes
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import Parameter
from stereo_pick.ros.misspelled import warn_of_misspelled
from stereo_pick.ros.nodes.calibration import CalibrationNode
from stereo_pick.ros.nodes.capture import CaptureNode
from stereo_pick.ros.nodes.correspondence import CorrespondenceNode
from stereo_pick.ros.nodes.rectification import RectificationNode
from stereo_pick.ros.nodes.triangulation import TriangulationNode
from stereo_pick.ros.parameters import LiveParameters, given_values
from stereo_pick.ros.qos_overrides import warn_of_vain_overrides
from stereo_pick.ros.topics import TOPICS
from stereo_pick.ros.unread_files import is_for, warn_of_unread

DEMO = Path(__file__).parents[2] / "bags" / "demo"
CLASSES = {
    "capture": CaptureNode,
    "rectification": RectificationNode,
    "correspondence": CorrespondenceNode,
    "triangulation": TriangulationNode,
    "calibration": CalibrationNode,
}
# What nobody can guess has no default.
GIVEN = {"source": str(DEMO), "board": "9x6", "square_m": "0.03", "output": "my_rig"}


@pytest.fixture(scope="module")
def hosted() -> Iterator[tuple[Graph, dict[str, Any]]]:
    """One node of each kind beside the test's own; each test leaves their parameters as they were."""
    with reserved_domain() as domain:
        graph = Graph(domain, [part for name, value in GIVEN.items() for part in ("-p", f"{name}:={value}")])
        yield graph, {name: graph.host(make(graph.context)) for name, make in CLASSES.items()}
        graph.close()


def parameters_of(name: str) -> dict[str, Parameter]:
    return declared_nodes()[name]


@pytest.mark.parametrize("name", CLASSES)
def test_a_node_has_just_the_declared_parameters_with_ranges_and_meaning(hosted: Any, name: str) -> None:
    node = hosted[1][name]
    of_ros = {"use_sim_time", "start_type_description_service"}
    own = {n for n in node._parameters if n not in of_ros and not n.startswith("qos_overrides.")}
    assert own == set(parameters_of(name))
    for full_name, parameter in parameters_of(name).items():
        told = node.describe_parameter(full_name)
        assert told.description == parameter.doc
        assert told.read_only == parameter.fixed
        assert all(choice in told.additional_constraints for choice in parameter.choices)
        if full_name not in GIVEN:
            assert node.get_parameter(full_name).value == parameter.default
        ranges = [*told.integer_range, *told.floating_point_range]
        bounded = isinstance(parameter.default, (int, float)) and not isinstance(parameter.default, bool)
        assert len(ranges) == int(bounded and (parameter.low is not None or parameter.high is not None))
        for span in ranges:
            assert parameter.low is None or span.from_value == parameter.low
            assert parameter.high is None or span.to_value == parameter.high


@pytest.mark.parametrize(
    ("node", "name", "value", "parts"),
    [
        ("correspondence", "segmentation.min_area_px", 0, ["segmentation.min_area_px", "1", "1000000"]),
        ("correspondence", "segmentation.threshold_sigma", 50.5, ["segmentation.threshold_sigma", "50"]),
        ("correspondence", "segmentation.polarity", "grey", ["polarity = 'grey'", "auto, bright, dark"]),
        ("correspondence", "method", "guess", ["method = 'guess'", "feature", "ssd"]),
        ("correspondence", "ssd.widest_window_px", 4.5, ["expected 'Type.INTEGER'"]),
        ("correspondence", "feature.epipolar_tolerance_px", float("nan"), ["epipolar_tolerance_px"]),
        ("triangulation", "triangulation.max_ray_gap_m", 2.0, ["max_ray_gap_m", "1"]),
        ("rectification", "full_scale_16", 65536, ["full_scale_16", "65535"]),
        ("capture", "rate", 0.0, ["rate", "0.01"]),
        ("capture", "source", "/elsewhere", ["source", "read-only"]),
        ("capture", "left_topic", "/elsewhere", ["left_topic", "read-only"]),
    ],
)
def test_a_bad_value_is_refused_live_with_the_reason(
    hosted: Any, node: str, name: str, value: Any, parts: list[str]
) -> None:
    graph, nodes = hosted
    before, held = nodes[node].get_parameter(name).value, dict(nodes[node].parameters.values)
    result = graph.set_parameter(node, name, value)
    assert not result.successful
    for part in parts:
        assert part in result.reason
    assert nodes[node].get_parameter(name).value == before
    assert nodes[node].parameters.values == held


def test_a_good_value_takes_effect_live(hosted: Any) -> None:
    graph, nodes = hosted
    node = nodes["correspondence"]
    assert type(node.steps.method).__name__ == "Feature"
    assert graph.set_parameter("correspondence", "method", "ssd").successful
    assert type(node.steps.method).__name__ == "Ssd"
    assert graph.set_parameter("correspondence", "ssd.widest_window_px", 21).successful
    assert node.steps.method.widest_window_px == 21
    assert graph.set_parameter("correspondence", "segmentation.polarity", "dark").successful
    assert node.steps.detector.polarity == "dark"
    for name, value in (("method", "feature"), ("ssd.widest_window_px", 23), ("segmentation.polarity", "auto")):
        assert graph.set_parameter("correspondence", name, value).successful
    assert type(node.steps.method).__name__ == "Feature"


def test_a_set_is_taken_as_a_whole_or_not_at_all(hosted: Any) -> None:
    node = hosted[1]["correspondence"]
    held, steps = dict(node.parameters.values), node.steps
    good, bad = RosParameter("segmentation.min_area_px", value=99), RosParameter("method", value="guess")
    result = node.set_parameters_atomically([good, bad])
    assert not result.successful
    assert node.parameters.values == held
    assert node.steps is steps


def test_a_set_refused_by_another_callback_leaves_the_old_values_standing(hosted: Any) -> None:
    graph, _ = hosted
    node = graph.host(_plain(graph, "refusing"))
    asked: list[str] = []

    def refuse(parameters: list[RosParameter]) -> SetParametersResult:
        asked.extend(parameter.name for parameter in parameters)
        return SetParametersResult(successful=not changes_are_refused, reason="somebody else says no")

    changes: list[None] = []
    changes_are_refused = False
    node.add_on_set_parameters_callback(refuse)  # called after the package's own, which is added later
    declared = {"gap_m": Parameter("gap_m", 0.5, "A gap.", 0.0, 1.0)}
    live = LiveParameters(node, declared, lambda values: None, lambda: changes.append(None))
    asked.clear()
    changes_are_refused = True

    result = graph.set_parameter("refusing", "gap_m", 0.7)
    assert (result.successful, result.reason) == (False, "somebody else says no")
    assert asked == ["gap_m"]
    assert live.values == {"gap_m": 0.5}
    assert changes == []


def test_parameters_of_others_do_not_disturb(hosted: Any) -> None:
    graph, nodes = hosted
    node = nodes["triangulation"]
    steps = node.steps
    assert graph.set_parameter("triangulation", "use_sim_time", False).successful
    assert node.steps is steps


@pytest.mark.parametrize(
    ("node", "assignment", "parts"),
    [
        ("correspondence", "segmentation.min_area_px:=0", ["segmentation.min_area_px", "1 .. 1e+06"]),
        ("correspondence", "method:=guess", ["method = 'guess'", "feature, ssd"]),
        ("triangulation", "triangulation.max_ray_gap_m:=1", ["max_ray_gap_m", "float", "1.0"]),
        ("correspondence", "segmentation.min_area_px:=60.0", ["min_area_px", "int", "whole number without a point"]),
        ("correspondence", "method:=1", ["method", "str", "needs quotes"]),
        ("capture", "loop:=1", ["loop", "bool", "true or false"]),
        ("triangulation", "triangulation.max_ray_gap_m:=7.5", ["max_ray_gap_m", "0.0001 .. 1"]),
        ("rectification", "max_stamp_offset_s:=.nan", ["max_stamp_offset_s"]),
        ("capture", "rate:=-1.0", ["rate", "0.01 .. 100"]),
        ("capture", "source:=''", ["source is empty", "give a bag"]),
        ("calibration", "baseline_m:=60.0", ["baseline_m", "0 .. 5", "60"]),
        ("capture", "use_sim_time:=1", ["use_sim_time must be of type bool (true or false): ", "'1'"]),
        ("rectification", "start_type_description_service:='no'", ["start_type_description_service must be", "bool"]),
    ],
)
def test_a_bad_value_at_the_start_is_refused_with_the_reason(node: str, assignment: str, parts: list[str]) -> None:
    with reserved_domain() as domain:
        graph = Graph(domain, ["-p", assignment])
        try:
            with pytest.raises(ParameterError) as error:
                CLASSES[node](graph.context)
        finally:
            graph.close()
    for part in parts:
        assert part in str(error.value)
    assert "\n" not in str(error.value)


def _plain(graph: Graph, name: str) -> Any:
    return rclpy.create_node(name, context=graph.context, use_global_arguments=False)


@pytest.mark.parametrize("value", ["reliability:=relable", "reliability:=true", "depth:=-3", "depth:=0", "depth:=2.5"])
def test_a_bad_quality_of_service_is_refused_by_its_parameter(value: str, capfd: pytest.CaptureFixture[str]) -> None:
    with reserved_domain() as domain:
        graph = Graph(domain, ["-p", f"qos_overrides./left/image_raw.subscription.{value}"])
        with pytest.raises(ParameterError, match=r"qos_overrides\./left/image_raw\.subscription\.\*: reliability is"):
            RectificationNode(graph.context)
        graph.close()
    assert "rcutils" not in capfd.readouterr().err


IN_CELL_1 = ["-r", "__ns:=/cell1", "-r", "right/image_raw:=/cam_b/image"]


@pytest.mark.parametrize(
    ("override", "ros_args", "said"),
    [
        ("./left/image_raw.subscription.depth:=20", [], ""),
        ("./cell1/left/image_raw.subscription.depth:=20", IN_CELL_1, ""),
        ("./cam_b/image.subscription.depth:=20", IN_CELL_1, ""),
        ("./cell1/object_poses.publisher.depth:=20", IN_CELL_1, ""),  # another node's
        ("./left/image_raw.publisher.depth:=20", [], ""),  # another node's
        ("./left/image_raw.subscription.depth:=20", IN_CELL_1, "the topic is /cell1/left/image_raw here"),
        ("./right/image_raw.subscription.depth:=20", IN_CELL_1, "the topic is /cam_b/image here"),
        (".left/image_raw.subscription.depth:=20", [], "the topic is /left/image_raw here"),
        ("./calibration/image_annotated.publisher.depth:=20", IN_CELL_1, "is /cell1/calibration/image_annotated here"),
        ("./left/imgae_raw.subscription.depth:=20", [], "there is no such topic; did you mean /left/image_raw?"),
        ("./robot.subscription.depth:=20", [], "qos_overrides./robot changes nothing: there is no such topic"),
        ("./left/image_raw.subscriber.depth:=20", [], "'subscriber' must be one of: publisher, subscription"),
        ("./left/image_raw.subscription.dept:=20", [], "'dept' must be one of: history, depth, reliability"),
        ("./left/image_raw:=20", [], "qos_overrides./left/image_raw = 20 changes nothing: give it as"),
        (":=3", [], "qos_overrides = 3 changes nothing: give it as qos_overrides.<topic>.publisher|subscription."),
    ],
)
def test_an_override_of_quality_of_service_that_changes_nothing_is_told_of(
    override: str, ros_args: list[str], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = told_of_overrides(["-p", f"qos_overrides{override}", *ros_args], monkeypatch)
    assert [said in text for text in told] == ([True] if said else [])


def test_a_file_may_name_the_topics_of_several_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    depths = [f"qos_overrides./cell{cell}/left/image_raw.subscription.depth:=20" for cell in (1, 2, 3)]
    assert not told_of_overrides([*(part for depth in depths for part in ("-p", depth)), *IN_CELL_1], monkeypatch)


def told_of_overrides(ros_args: list[str], monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What two nodes in one process log at their start of parameters that change nothing."""
    told = list[str]()
    with reserved_domain() as domain:
        graph = Graph(domain, ros_args)
        nodes = [make(graph.context) for make in (RectificationNode, TriangulationNode)]
        monkeypatch.setattr(type(nodes[0].get_logger()), "warning", lambda _, message: told.append(message))
        warn_of_misspelled(nodes)
        warn_of_vain_overrides(nodes)
        for node in nodes:
            node.destroy_node()
        graph.close()
    return told


def test_no_topic_is_missing_from_those_that_can_be_overridden(hosted: Any) -> None:
    given = {name.split(".")[1] for node in hosted[1].values() for name in node._parameters if "qos_overrides" in name}
    assert given == {f"/{topic.name.removeprefix('/')}" for topic in TOPICS}


@pytest.mark.parametrize(
    ("section", "meant"),
    [
        ("/**/correspondence", ""),
        ("/**", ""),
        ("/*/correspondence", ""),
        ("cell1/correspondence", ""),
        ("correspondence", "/correspondence"),
        ("/**/corespondence", "/**/corespondence"),
        ("/cell2/correspondence", "/cell2/correspondence"),
        ("/cell1/*/correspondence", "/cell1/*/correspondence"),
        ("/cell1/triangulation", ""),
        ("another_packages_node", ""),
    ],
)
def test_a_file_with_a_section_under_a_wrong_name_is_told_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, section: str, meant: str
) -> None:
    file = tmp_path / "my.yaml"
    file.write_text(yaml.safe_dump({section: {"ros__parameters": {"method": "ssd"}}}))
    given, told = given_and_told(file, monkeypatch)
    assert ("method" in given) == is_for(section, "/cell1/correspondence")
    assert [f"if its section {meant} is meant" in text for text in told] == ([True] if meant else [])


@pytest.mark.parametrize("text", ["", "# method: ssd", "hello", "{}"])
def test_a_file_without_a_section_is_told_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    file = tmp_path / "my.yaml"
    file.write_text(text)
    _, told = given_and_told(file, monkeypatch)
    assert len(told) == 1 and told[0].startswith(f"{file} has no parameters in it: they stand below the name of a node")


@pytest.mark.parametrize("text", ["method: !mine ssd", "method: ssd}}\n---\n/**: {ros__parameters: {rate: 2.0"])
def test_a_file_that_ros_reads_ends_no_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    """Tags, and a second document, ended in a traceback."""
    file = tmp_path / "my.yaml"
    file.write_text(f"/**: {{ros__parameters: {{{text}}}}}")
    given, told = given_and_told(file, monkeypatch)
    assert "method" in given and not told


def given_and_told(file: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[dict[str, object], list[str]]:
    """Which parameters two nodes in one process, in the namespace cell1, have of a file, and what they log of it."""
    args, told = ["--ros-args", "-r", "__ns:=/cell1", "--params-file", str(file)], list[str]()
    with reserved_domain() as domain:
        graph = Graph(domain, args[1:])
        nodes = [rclpy.create_node(name, context=graph.context) for name in ("correspondence", "rectification")]
        monkeypatch.setattr(type(nodes[0].get_logger()), "warning", lambda _, message: told.append(message))
        given = given_values(nodes[0])
        warn_of_unread(nodes, args)
        for node in nodes:
            node.destroy_node()
        graph.close()
    return given, told
