"""Markup: no text becomes an element or an attribute, and none is lost."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.core.calibration_page.markup import Markup, element, number, table

# XML turns \r into \n; surrogates and control characters are no text in it.
XML_TEXT = st.text(st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\ufffe\uffff"))


@given(XML_TEXT)
def test_any_text_is_read_back_as_it_was(text: str) -> None:
    root = ET.fromstring(element("p", text, element("b", "x"), title=text))
    assert (root.text or "") == text
    assert root.get("title") == text
    assert [child.tag for child in root] == ["b"]


@given(st.text())
def test_whatever_the_text_there_is_one_element_that_can_be_written(text: str) -> None:
    class Tags(HTMLParser):
        seen: list[str] = []  # noqa: RUF012

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.seen = [*self.seen, tag]

    markup = element("p", text, title=text)
    parser = Tags()
    parser.feed(markup)
    assert parser.seen == ["p"]
    assert ET.fromstring(markup.encode("utf-8")).tag == "p"


@pytest.mark.parametrize("name", ["bad\udcffname", "nul\x00", "bell\x07", "\ufffe"])
def test_what_is_no_text_is_replaced(name: str) -> None:
    assert "\N{REPLACEMENT CHARACTER}" in ET.fromstring(element("p", name).encode("utf-8")).text


def test_markup_is_not_escaped_again() -> None:
    assert element("p", element("b", "a < b")) == "<p><b>a &lt; b</b></p>"
    assert element("p", Markup("<i/>")) == "<p><i/></p>"


def test_attributes_are_named_as_in_svg() -> None:
    assert element("line", x1=1.0, stroke_width=0.25, class_="a") == '<line x1="1" stroke-width="0.25" class="a"/>'


@pytest.mark.parametrize(("value", "text"), [(100.0, "100"), (0.256, "0.26"), (-3.1, "-3.1"), (0.001, "0")])
def test_numbers_are_short(value: float, text: str) -> None:
    assert number(value) == text


def test_rows_have_a_heading() -> None:
    root = ET.fromstring(table("caption", ("", "value"), [("a", "1"), ("b", "2")]))
    assert [cell.tag for row in root.iter("tbody") for cell in row[0]] == ["th", "td"]
    assert [cell.get("scope") for cell in root.iter("th")] == ["col", "col", "row", "row"]
