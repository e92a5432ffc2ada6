"""Text for people: counts with their nouns, and nothing that a terminal obeys."""

from __future__ import annotations

from workbench.core.text import counted, plain


def test_one_is_one_and_all_else_are_many() -> None:
    assert [counted(n, "row") for n in (0, 1, 2)] == ["0 rows", "1 row", "2 rows"]


def test_what_a_terminal_obeys_becomes_a_box() -> None:
    assert plain("a\x1b[31mb\u202e") == "a\ufffd[31mb\ufffd"
