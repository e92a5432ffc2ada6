"""Every byte that no edit touches stays as somebody wrote it."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.core import InputError
from workbench.core.xml_text import XmlText

_NAMES = st.sampled_from(["a", "body", "joint", "x-1", "gé"])
_BLANK = st.sampled_from([" ", "\n", "\r\n\t", "  "])
_MAYBE = st.one_of(st.just(""), _BLANK)
_VALUE = st.text(st.sampled_from("a1é >/=&;-."), max_size=6).map(lambda t: t.replace("&", "&amp;"))
_BETWEEN = st.sampled_from(
    ["", "\r\n  ", "text", "<!-- <joint name='no'/> é -->", "<?go <x/> ?>", "<![CDATA[<a b='1'>]]>", "&lt;"]
)


@st.composite
def _element(draw: st.DrawFn, depth: int = 0) -> str:
    name = draw(_NAMES)
    attributes = ""
    for key in draw(st.lists(st.sampled_from(["name", "damping", "é", "b"]), unique=True, max_size=3)):
        quote, equals = draw(st.sampled_from("'\"")), draw(st.sampled_from(["=", " = ", "=\r\n"]))
        attributes += f"{draw(_BLANK)}{key}{equals}{quote}{draw(_VALUE)}{quote}"
    attributes += draw(_MAYBE)
    inner = draw(st.lists(_element(depth + 1), max_size=3)) if depth < 3 else []
    if not inner and draw(st.booleans()):
        return f"<{name}{attributes}/>"
    content = draw(_BETWEEN) + "".join(each + draw(_BETWEEN) for each in inner)
    return f"<{name}{attributes}>{content}</{name}{draw(_MAYBE)}>"


@st.composite
def documents(draw: st.DrawFn) -> bytes:
    encoding = draw(st.sampled_from(["", "utf-8", "iso-8859-1", "utf-8-sig"]))
    head = draw(st.sampled_from(["<!-- é -->\r\n", "", "\n"]))
    said = "utf-8" if encoding.startswith("utf-8") else encoding
    declared = f'<?xml version="1.0" encoding="{said}"?>\n' if encoding else ""
    return (declared + (head if encoding else "") + draw(_element())).encode(encoding or "utf-8")


@given(documents())
def test_without_an_edit_every_byte_stays(raw: bytes) -> None:
    text = XmlText(raw)
    assert text.result() == raw
    assert len(text.elements) == len(list(ElementTree.fromstring(raw).iter()))
    for element in text.elements:
        part = raw[element.start : element.end]
        assert part.startswith(b"<") and part.endswith(b">")


@settings(max_examples=200)
@given(documents(), st.data())
def test_an_edit_changes_that_attribute_alone(raw: bytes, data: st.DataObject) -> None:
    text = XmlText(raw)
    k = data.draw(st.integers(0, len(text.elements) - 1))
    name = data.draw(st.sampled_from(["damping", "name", "armature"]))
    value = data.draw(st.one_of(st.none(), st.text(st.sampled_from("0.1 <&\"'\n"), max_size=5)))
    had = text.elements[k].get(name)
    text.set(text.elements[k], {name: value})
    after = text.result()
    wanted = list(ElementTree.fromstring(raw).iter())
    if value is None:
        wanted[k].attrib.pop(name, None)
    else:
        wanted[k].set(name, value)
    found = list(ElementTree.fromstring(after).iter())
    assert [(e.tag, e.attrib, e.text, e.tail) for e in found] == [
        (e.tag, e.attrib, e.text, e.tail) for e in wanted
    ]
    # what stands before and behind the tag is the same bytes
    start = text.elements[k].start
    assert after[:start] == raw[:start]
    again = XmlText(after)  # and back
    again.set(again.elements[k], {name: had})
    if value is not None or had is None:
        same = XmlText(again.result()).elements[k]
        assert same.get(name) == had
        if had is None:
            assert again.result() == raw


@given(documents(), st.data())
def test_a_new_element_comes_behind_and_nothing_else_changes(raw: bytes, data: st.DataObject) -> None:
    text = XmlText(raw)
    if len(text.elements) == 1:
        return
    at = data.draw(st.sampled_from(text.elements[1:]))
    text.add_after(at, "new", {"b": "1 2"})
    after = text.result()
    assert after[: at.end] == raw[: at.end] and after.endswith(raw[at.end :])
    found = XmlText(after)
    assert len(found.elements) == len(text.elements) + 1
    assert at.parent is not None
    k = text.elements.index(at.parent)
    tags = [child.tag for child in found.elements[k].children]
    assert tags[at.parent.children.index(at) + 1] == "new"


def test_a_new_element_stands_on_a_line_like_its_neighbour() -> None:
    text = XmlText(b"<a>\r\n\t<b/>\r\n</a>")
    text.add_after(text.elements[1], "c", {"d": "1"})
    assert text.result() == b'<a>\r\n\t<b/>\r\n\t<c d="1"/>\r\n</a>'


def test_quotes_are_those_of_the_neighbour() -> None:
    text = XmlText(b"<a b='1'><c/></a>")
    text.set(text.elements[0], {"d": "2"})
    text.set(text.elements[1], {"d": "3", "e": "4"})
    assert text.result() == b"<a b='1' d='2'><c d=\"3\" e=\"4\"/></a>"


def test_prefixes_that_nobody_declared_do_no_harm() -> None:
    text = XmlText(b"<robot><x:link name='a'/></robot>")
    assert text.elements[1].tag == "link"


@pytest.mark.parametrize("raw", [b"", b"<a>", b"<!DOCTYPE a><a/>", "<a/>".encode("utf-16")])
def test_what_is_no_xml_is_refused(raw: bytes) -> None:
    with pytest.raises(InputError):
        XmlText(raw)
