"""What the calibration node says of itself: what to show, what it does, what to do next."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from board_bags import BOARD, GREY, rendered_pairs
from ros_tools import Graph, reserved_domain
from std_srvs.srv import Trigger

from stereo_pick.core.calibration.collecting import timed_pair
from stereo_pick.core.calibration.verdict import Verdict, Word
from stereo_pick.ros.messages.diagnostics import OK, WARN
from stereo_pick.ros.nodes import calibration
from stereo_pick.ros.nodes.calibration import CalibrationNode


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[Graph]:
    values = {"board": f"chessboard:{BOARD}", "square_m": BOARD.square_m, "output": tmp_path / "new" / "rig"}
    with reserved_domain() as domain:
        graph = Graph(domain, [part for name, value in values.items() for part in ("-p", f"{name}:={value}")])
        yield graph
        graph.close()


@pytest.fixture
def node(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> CalibrationNode:
    """A node whose cameras run."""
    node = graph.host(CalibrationNode(graph.context))
    monkeypatch.setattr(node._raw, "trouble", lambda: None)
    return node


@pytest.fixture
def nothing_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration, "guide", lambda *_: SimpleNamespace(missing=()))


def show(graph: Graph, node: CalibrationNode, *pairs: tuple) -> None:
    already = node._watch.progress.looked_at
    for index, pair in enumerate(pairs):
        node._watch.offer(lambda index=index, pair=pair: timed_pair(index, *pair))
    graph.wait(lambda: node._watch.progress.looked_at == already + len(pairs), "all pairs looked at")


def test_a_board_that_was_never_seen_is_told_before_finish(
    graph: Graph, node: CalibrationNode, render_board: Callable
) -> None:
    """One of another size, say, is in view: to be told where to show it is no help."""
    show(graph, node, *[(GREY, GREY)] * 19)
    assert "show 15 more views" in node.status().message
    show(graph, node, (GREY, GREY))
    status = node.status()
    assert status.level == WARN
    assert status.message.startswith(
        "no chessboard of 7x5 inner corners found in both images of any of 20 pairs: count"
    )
    assert status.values["with_board"] == "0"
    show(graph, node, rendered_pairs(render_board)[0])
    assert node.status().message.startswith("1 views kept; show 14 more views")


@pytest.mark.usefixtures("nothing_missing")
def test_pairs_that_were_left_out_are_counted_and_no_warning(node: CalibrationNode) -> None:
    node._watch.not_looked_at = 3
    status = node.status()
    assert status.level == OK
    assert status.message == (
        "0 views kept; call ~/finish; 3 pairs were not looked at: they come faster than the board is found"
    )


@pytest.mark.usefixtures("nothing_missing")
def test_what_to_call_next_is_told_and_logged_until_all_is_saved(
    graph: Graph,
    node: CalibrationNode,
    render_board: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = SimpleNamespace(verdict=Verdict(Word.GOOD, ()), summary="good", save=lambda folder: [folder])
    monkeypatch.setattr(calibration, "calibrate_from", lambda *_: run)
    logged = list[str]()
    monkeypatch.setattr(node, "get_logger", lambda: SimpleNamespace(info=logged.append, warning=logged.append))
    show(graph, node, rendered_pairs(render_board)[0])
    steps = ("call ~/finish", "call ~/save", "the calibration is saved")
    for step, service in zip(steps, ("finish", "save", "")):
        node.report()
        assert node.status().message == f"1 views kept; {step}"
        assert logged[-1].endswith(f" views kept; {step}")
        if service:
            assert graph.ask(Trigger, f"calibration/{service}", Trigger.Request()).success
