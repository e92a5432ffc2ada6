"""XML edited as text: attributes and elements change, every other byte stays as it is.

Nothing is written anew: comments, blanks, the order and the quotes of attributes, line ends, a byte order
mark and the encoding are those of the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat
from xml.sax.saxutils import escape

from .xml import parse_xml

_SPACE = rb"[ \t\r\n]"
_NAME = re.compile(rb"<[^ \t\r\n/>]+")
#: One attribute: the blank before it, its name, and its value between quotes.
_ATTRIBUTE = re.compile(rb"(%s+)([^ \t\r\n=/>]+)%s*=%s*(?:\"([^\"]*)\"|'([^']*)')" % (_SPACE, _SPACE, _SPACE))
_LEAD = re.compile(rb"(?:\r\n|\n|\r)[ \t]*\Z")


@dataclass(eq=False)
class Element:
    """An element of a document.

    Attributes:
        tag: its name, without a prefix.
        attributes: values by name, as a parser reads them.
        parent: the element around it; None for the root.
        children: the elements in it, in order.
        start, end: bytes from its first ``<`` to behind its last ``>``.
    """

    tag: str
    attributes: dict[str, str]
    parent: Element | None
    start: int
    end: int = 0
    children: list[Element] = field(default_factory=list)

    def get(self, name: str) -> str | None:
        """Return the value of an attribute; None if it is missing."""
        return self.attributes.get(name)

    def child(self, tag: str) -> Element | None:
        """Return the first child with this name."""
        return next((each for each in self.children if each.tag == tag), None)

    def around(self) -> Iterator[Element]:
        """Return the elements that contain this one, the nearest first."""
        outer = self.parent
        while outer is not None:
            yield outer
            outer = outer.parent


class XmlText:
    """A document and the edits to be made to it."""

    def __init__(self, raw: bytes, file: Path | None = None) -> None:
        """Find the position of every element.

        Args:
            raw: the document.
            file: where it is from, for the error.

        Raises:
            InputError: as `parse_xml`, undeclared prefixes apart.
        """
        parse_xml(raw, file, prefixes=False)
        self._raw, self.file = raw, file
        self.elements: list[Element] = []
        self._set: dict[Element, dict[str, str | None]] = {}
        self._added: dict[Element, list[str]] = {}
        self._find()

    def _find(self) -> None:
        parser, within = expat.ParserCreate(), list[Element]()

        def start(tag: str, attributes: dict[str, str]) -> None:
            parent = within[-1] if within else None
            element = Element(tag.rpartition(":")[2], attributes, parent, parser.CurrentByteIndex)
            self.elements.append(element)
            if parent is not None:
                parent.children.append(element)
            within.append(element)

        def end(tag: str) -> None:
            element, at = within.pop(), parser.CurrentByteIndex
            # of an element without content the parser stands behind it already
            closed = self._raw.startswith(b"</", at) and not self._alone(element)
            element.end = self._raw.index(b">", at) + 1 if closed else self._tag_end(element)

        parser.StartElementHandler, parser.EndElementHandler = start, end
        parser.Parse(self._raw, True)

    @property
    def root(self) -> Element:
        """Return the outermost element."""
        return self.elements[0]

    def set(self, element: Element, values: Mapping[str, str | None]) -> None:
        """Set attributes of an element; None removes an attribute."""
        self._set.setdefault(element, {}).update(values)

    def add_after(self, element: Element, tag: str, values: Mapping[str, str]) -> None:
        """Add an empty element after an element, on a line of its own if that element has one."""
        self._added.setdefault(element, []).append(
            f"<{tag}" + "".join(f' {name}="{_quotable(value)}"' for name, value in values.items()) + "/>"
        )

    def result(self) -> bytes:
        """Return the document with all edits."""
        changes: list[tuple[int, int, bytes]] = []
        for element, values in self._set.items():
            changes += self._changed(element, values)
        for element, texts in self._added.items():
            lead = _LEAD.search(self._raw, 0, element.start)
            before = lead[0] if lead else b""
            changes.append((element.end, element.end, b"".join(before + text.encode() for text in texts)))
        out, at = list[bytes](), 0
        for first, last, text in sorted(changes, key=lambda change: change[:2]):
            out += [self._raw[at:first], text]
            at = last
        return b"".join([*out, self._raw[at:]])

    def _changed(
        self, element: Element, values: Mapping[str, str | None]
    ) -> Iterator[tuple[int, int, bytes]]:
        """Return start, end and replacement of the changed bytes."""
        found = {each[2].decode("latin-1"): each for each in self._attributes(element)}
        for name, value in values.items():
            if name not in found:
                continue
            each = found[name]
            if value is None:
                yield each.start(), each.end(), b""
            else:
                group = 3 if each[3] is not None else 4
                yield each.start(group), each.end(group), _quotable(value).encode()
        last = max(found.values(), key=lambda each: each.start(), default=None)
        quote = b"'" if last is not None and last[4] is not None else b'"'
        behind = self._name_end(element) if last is None else last.end()
        new = {n: v for n, v in values.items() if n not in found and v is not None}
        if new:
            texts = (
                b" %s=%s%s%s" % (n.encode(), quote, _quotable(v).encode(), quote) for n, v in new.items()
            )
            yield behind, behind, b"".join(texts)

    def _name_end(self, element: Element) -> int:
        name = _NAME.match(self._raw, element.start)
        assert name is not None  # a parser has read it
        return name.end()

    def _attributes(self, element: Element) -> Iterator[re.Match[bytes]]:
        at = self._name_end(element)
        while each := _ATTRIBUTE.match(self._raw, at):
            yield each
            at = each.end()

    def _tag_end(self, element: Element) -> int:
        """Return the position after the ``>`` of its start tag."""
        ends = [each.end() for each in self._attributes(element)]
        return self._raw.index(b">", ends[-1] if ends else self._name_end(element)) + 1

    def _alone(self, element: Element) -> bool:
        """Return whether it is written ``<x/>``."""
        end = self._tag_end(element)
        return self._raw[end - 2 : end] == b"/>"


def _quotable(value: str) -> str:
    text = escape(value, {'"': "&quot;", "'": "&apos;", "\t": "&#9;", "\n": "&#10;", "\r": "&#13;"})
    return text.encode("ascii", "xmlcharrefreplace").decode()
