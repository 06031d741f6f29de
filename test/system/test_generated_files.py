"""What is generated from the declarations is current, and its users accept it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
import yaml

from stereo_pick.cli import parameters
from stereo_pick.core import configuration
from stereo_pick.core.correspondence import methods

ROOT = Path(__file__).parents[2]
METHODS = ROOT / "stereo_pick" / "core" / "correspondence"


@pytest.fixture
def committed_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the methods that git tracks: one that is being tried out needs no documentation yet."""
    listed = subprocess.run(["git", "ls-files", "."], cwd=METHODS, capture_output=True, text=True, check=False)
    tracked = {Path(name).stem for name in listed.stdout.split()}
    if listed.returncode == 0 and tracked:
        known = {name: method for name, method in methods().items() if name in tracked}
        monkeypatch.setattr(configuration, "methods", lambda: known)


@pytest.mark.usefixtures("committed_methods")
def test_docs_parameters_md_is_current() -> None:
    assert (ROOT / "docs" / "parameters.md").read_text() == parameters.markdown_text(), "run `make docs`"


@pytest.mark.usefixtures("committed_methods")
def test_config_stereo_pick_yaml_is_current() -> None:
    assert (ROOT / "config" / "stereo_pick.yaml").read_text() == parameters.yaml_text(), "run `make docs`"


def test_the_yaml_holds_every_default() -> None:
    content = yaml.safe_load(parameters.yaml_text())
    assert set(content) == {f"/**/{node}" for node in parameters.nodes()}
    for node, declared in parameters.nodes().items():
        for name, parameter in declared.items():
            if parameter.fixed and parameter.default in ("", 0.0):
                continue  # must be chosen, and stands there as a comment
            value = content[f"/**/{node}"]["ros__parameters"]
            for part in name.split("."):
                value = value[part]
            assert value == parameter.default
            assert type(value) is type(parameter.default)


def test_the_documentation_has_a_row_for_every_parameter() -> None:
    sections = parameters.markdown_text().split("\n## ")
    for node, declared in parameters.nodes().items():
        lines = [line for section in sections if section.startswith(node) for line in section.splitlines()]
        for name, parameter in declared.items():
            (row,) = [line for line in lines if line.startswith(f"| `{name}` |") and parameter.doc in line]
            assert row.count(" | ") == 3
