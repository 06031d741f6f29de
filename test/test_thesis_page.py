"""docs/thesis.md: every equation and table of chapters 1 and 3 has a place in the code that exists, or a reason."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "thesis.md"
EQUATIONS = [*(f"1.{n}" for n in range(1, 44)), *(f"3.{n}" for n in range(1, 22))]
TABLES = [f"3.{n}" for n in range(1, 17)]
SECTIONS = ("3.3", "3.4", "3.5", "3.6", "3.7", "3.7.1", "3.7.2", "3.7.3", "3.8", "3.9")
LINK = re.compile(r"\[`([\w.]+)`\]\(\.\./([\w/]+\.py)\)")
REASON = re.compile(r"not (?:used|repeated):? \w+")


def rows(heading: str) -> list[list[str]]:
    """The cells of the first table under a heading."""
    after = PAGE.read_text(encoding="utf-8").split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    lines = re.search(r"(?:^\|.*\n)+", after, re.M)
    assert lines, f"no table under {heading}"
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines[0].splitlines()[2:]]


def numbers(cell: str, chapter: str) -> Iterator[str]:
    """The equations or tables that a cell names, ranges spelled out: 1.4–1.6 is 1.4, 1.5 and 1.6. § is a section."""
    for first, last in re.findall(rf"(?<!§ )\b{chapter}\.(\d+)(?:–{chapter}\.(\d+))?(?![.\d])", cell):
        yield from (f"{chapter}.{n}" for n in range(int(first), int(last or first) + 1))


def symbols(file: Path) -> set[str]:
    """Functions, classes, and methods and fields of classes, that a file defines."""
    found = set()
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
        if isinstance(node, ast.ClassDef):
            members = [item.name for item in node.body if isinstance(item, ast.FunctionDef)]
            fields = [item.target for item in node.body if isinstance(item, ast.AnnAssign)]
            members += [target.id for target in fields if isinstance(target, ast.Name)]
            found |= {f"{node.name}.{member}" for member in members}
    return found


@pytest.mark.parametrize("number", EQUATIONS)
def test_every_equation_has_a_place_or_a_reason(number: str) -> None:
    chapter = number[0]
    named = [row for row in rows(f"Chapter {chapter}") if number in numbers(row[0], chapter)]
    assert named, f"equation {number} is not on the page"
    assert all(LINK.search(row[2]) or REASON.search(row[3]) for row in named), named


@pytest.mark.parametrize("number", TABLES)
def test_every_table_has_a_row_with_its_program(number: str) -> None:
    (row,) = [row for row in rows("Tables") if number in numbers(row[0], "3")]
    assert LINK.search(row[4]) and row[2] and row[3]


def test_every_method_of_chapter_3_is_named() -> None:
    cells = [row[0] for row in rows("Chapter 3")]
    assert [s for s in SECTIONS if not any(re.search(rf"§ {s}(?![.\d])", cell) for cell in cells)] == []


def test_every_place_exists() -> None:
    places = LINK.findall(PAGE.read_text(encoding="utf-8"))
    assert len(places) > 40
    missing = [f"{name} in {file}" for name, file in places if name not in symbols(ROOT / file)]
    assert missing == [], "docs/thesis.md names what is not there"


def test_every_link_on_the_page_leads_somewhere() -> None:
    text = PAGE.read_text(encoding="utf-8")
    headings = [re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower()).replace(" ", "-")
                for line in text.splitlines() if line.startswith("#")]  # fmt: skip
    anchors = re.findall(r"\]\(#([^)]+)\)", text)
    assert [each for each in anchors if each not in headings] == []
    files = re.findall(r"\]\((?!#|https?:)([^)#]+)", text)
    assert [each for each in files if not (PAGE.parent / each).exists()] == []


def test_what_is_looked_for_can_be_missing() -> None:
    assert list(numbers("1.4–1.6, 1.10", "1")) == ["1.4", "1.5", "1.6", "1.10"]
    assert list(numbers("§ 3.7.2, steps 1 to 5, § 3.8", "3")) == []
    assert "closest_points" in symbols(ROOT / "stereo_pick/core/rays.py")
    assert "nowhere" not in symbols(ROOT / "stereo_pick/core/rays.py")
    assert not LINK.search("–") and not REASON.search("as printed")
