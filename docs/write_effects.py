"""Writes the table in effects.md from the code's catalogue.

python docs/write_effects.py            # rewrites the table
python docs/write_effects.py --check    # exit code 1 where it is not current
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from workbench.effects import EFFECTS, Effect

PAGE = Path(__file__).with_name("effects.md")
START, END = "<!-- catalogue: written by write_effects.py -->\n", "<!-- end of catalogue -->\n"


def main() -> None:
    """Rewrites or checks the page."""
    old = PAGE.read_text(encoding="utf-8")
    new = page(old)
    if "--check" in sys.argv[1:]:
        sys.exit(None if new == old else "docs/effects.md is not current: run python docs/write_effects.py")
    PAGE.write_text(new, encoding="utf-8")


def page(old: str) -> str:
    """The page with a fresh catalogue between its marks."""
    before, rest = old.split(START)
    after = rest.split(END)[1]
    return before + START + "\n" + "\n".join(catalogue()) + "\n" + END + after


def catalogue() -> Iterator[str]:
    """One table to look names up in, then a paragraph an effect."""
    yield "| name | acts on | parameters |"
    yield "|---|---|---|"
    for effect in EFFECTS:
        yield f"| [`{effect.name}`](#{effect.name}) | {where(effect)} | {parameters(effect)} |"
    for effect in EFFECTS:
        about = (effect.__doc__ or "").splitlines()[0].rstrip(".")
        yield f"\n### {effect.name}\n"
        if PAGE.with_name("images").joinpath("effects", f"{effect.name}.png").is_file():
            yield f"![Its signature over speed, position and time](images/effects/{effect.name}.png)\n"
        yield f"- Equation: {escaped(about)}"
        yield f"- Source: {escaped(effect.words.source)}"
        yield f"- Shows in: {escaped(effect.words.shows)}"
        yield f"- Stands out in: {escaped(effect.words.reveal)}"
        yield f"- In MuJoCo: {escaped(effect.words.mujoco)}"
        if effect.search.contains:
            yield f"- Contains: {', '.join(f'`{name}`' for name in effect.search.contains)}"
        if effect.search.twins:
            yield f"- Cannot be told from: {', '.join(f'`{name}`' for name in effect.search.twins)}"


def where(effect: Effect) -> str:
    """Axis and location in words."""
    if not effect.locations:
        return "the whole machine"
    return "one axis, drive or pin" if "joint" in effect.locations else "one axis, drive"


def parameters(effect: Effect) -> str:
    """Names with units."""
    return ", ".join(f"`{p.name}` [`{p.unit}`]" for p in effect.parameters) or "none"


def escaped(text: str) -> str:
    """Text with what Markdown would take for marks made plain."""
    for mark in "*_|<>":
        text = text.replace(mark, f"\\{mark}")
    return text


if __name__ == "__main__":
    main()
