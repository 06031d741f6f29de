"""Parameters: declared once, checked wherever a value comes from."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.configuration import pipeline_parameters
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import Configurable, Parameter, check_folder, parameter, path_of


@dataclass(frozen=True)
class Oven(Configurable):
    heat_k: float = parameter(450.0, "Heat.", low=300.0, high=600.0)
    trays: int = parameter(2, "Trays.", low=1, high=5)
    fan: bool = parameter(False, "Fan.")
    mode: str = parameter("top", "Mode.", choices=("top", "bottom"))


def named(name: str) -> Parameter:
    return next(each for each in Oven.parameters() if each.name == name)


def test_every_default_of_the_package_is_legal() -> None:
    for declared in pipeline_parameters().values():
        assert declared.checked(declared.default) == declared.default


def test_the_declared_names_come_in_order_with_their_meaning() -> None:
    assert [(each.name, each.doc) for each in Oven.parameters()] == [
        ("heat_k", "Heat."), ("trays", "Trays."), ("fan", "Fan."), ("mode", "Mode."),
    ]  # fmt: skip


@given(st.floats(allow_nan=True, allow_infinity=True))
def test_a_value_is_legal_exactly_within_its_range(heat_k: float) -> None:
    if 300 <= heat_k <= 600:
        assert Oven(heat_k=heat_k).heat_k == heat_k
    else:
        with pytest.raises(ParameterError, match="heat_k = "):
            Oven(heat_k=heat_k)


def test_a_value_out_of_range_is_refused_with_it_and_the_legal_range() -> None:
    with pytest.raises(ParameterError, match=r"trays = 9 is outside its range 1 \.\. 5"):
        Oven(trays=9)
    with pytest.raises(ParameterError, match="mode = 'grill' must be one of: top, bottom"):
        Oven(mode="grill")


@pytest.mark.parametrize(
    "wrong", [{"trays": 2.5}, {"trays": True}, {"heat_k": "450"}, {"heat_k": True}, {"fan": 1}, {"mode": 3}], ids=str
)
def test_another_type_is_refused_not_converted(wrong: dict[str, object]) -> None:
    with pytest.raises(ParameterError, match="must be of type"):
        Oven.from_mapping(wrong)


def test_a_whole_number_serves_as_a_float() -> None:
    heat_k = Oven.from_mapping({"heat_k": 500}).heat_k
    assert heat_k == 500.0 and type(heat_k) is float


def test_an_unknown_name_is_refused_with_those_there_are() -> None:
    with pytest.raises(ParameterError, match=r"no parameter 'haet_k'.*fan, heat_k, mode, trays"):
        Oven.from_mapping({"haet_k": 400.0})


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [("heat_k", "333.5", 333.5), ("heat_k", "400", 400.0), ("trays", "3", 3), ("fan", "True", True),
     ("fan", "false", False), ("mode", "bottom", "bottom")],
)  # fmt: skip
def test_text_is_read_in_the_parameters_own_type(name: str, text: str, value: object) -> None:
    parsed = named(name).parsed(text)
    assert parsed == value and type(parsed) is type(value)


@pytest.mark.parametrize(
    ("name", "text"),
    [("heat_k", "hot"), ("heat_k", "nan"), ("heat_k", "9000"), ("trays", "2.5"), ("trays", ""), ("fan", "1"),
     ("fan", "yes"), ("mode", "")],
)  # fmt: skip
def test_text_that_is_no_legal_value_is_refused(name: str, text: str) -> None:
    with pytest.raises(ParameterError, match=name):
        named(name).parsed(text)


@given(st.floats(300, 600))
def test_what_is_written_out_is_read_back(heat_k: float) -> None:
    assert named("heat_k").parsed(repr(heat_k)) == heat_k


def test_the_users_folder_is_put_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/me")
    assert path_of("~/my_rig") == Path("/home/me/my_rig")
    assert path_of("my_rig/~") == Path("my_rig/~")
    assert path_of("~nobody_of_that_name/my_rig") == Path("~nobody_of_that_name/my_rig")


def test_a_folder_to_write_to_is_one_or_can_be_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "file"
    file.touch()
    check_folder("--output", tmp_path)
    check_folder("--output", tmp_path / "new" / "rig")
    monkeypatch.chdir(tmp_path)
    check_folder("--output", Path("new/rig"))
    with pytest.raises(ParameterError, match="^--output is a file: name a folder$"):
        check_folder("--output", file)
    with pytest.raises(ParameterError, match=f"^--output cannot be made: {file} is a file$"):
        check_folder("--output", file / "rig")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_folder_that_cannot_be_written_to_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By what the system says of it: to the superuser a folder of any mode is open."""
    allowed = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: mode == os.F_OK and allowed(path, mode))
    with pytest.raises(ParameterError, match=f"^--output cannot be written: {tmp_path} is not yours to write to"):
        check_folder("--output", tmp_path / "new" / "rig")
