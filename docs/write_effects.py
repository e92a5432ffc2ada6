"""Writes the table in effects.md, and a page for each effect in effects/, from the code's catalogue.

python docs/write_effects.py            # rewrites them
python docs/write_effects.py --check    # exit code 1 where one is not current
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from workbench.effects import EFFECTS, Effect, Parameter

PAGE = Path(__file__).with_name("effects.md")
FOLDER = Path(__file__).with_name("effects")
START, END = "<!-- catalogue: written by write_effects.py -->\n", "<!-- end of catalogue -->\n"


def main() -> None:
    """Rewrites or checks the pages."""
    new = {PAGE: index(PAGE.read_text(encoding="utf-8"))}
    new |= {FOLDER / f"{effect.name}.md": "\n".join(page(effect)) + "\n" for effect in EFFECTS}
    old = {path: path.read_text(encoding="utf-8") for path in (PAGE, *FOLDER.glob("*.md"))}
    if "--check" in sys.argv[1:]:
        stale = sorted(p.name for p in {*new, *old} if new.get(p) != old.get(p))
        sys.exit(f"not current: {', '.join(stale)}: run python docs/write_effects.py" if stale else None)
    FOLDER.mkdir(exist_ok=True)
    for path in old.keys() - new.keys():
        path.unlink()
    for path, text in new.items():
        path.write_text(text, encoding="utf-8")


def index(old: str) -> str:
    """The list of all effects with a fresh table between its marks."""
    before, rest = old.split(START)
    after = rest.split(END)[1]
    return before + START + "\n" + "\n".join(table()) + "\n\n" + END + after


def table() -> Iterator[str]:
    """A row for each effect, with a link to its page."""
    yield "| name | acts on | parameters |"
    yield "|---|---|---|"
    for effect in EFFECTS:
        yield f"| [`{effect.name}`](effects/{effect.name}.md) | {where(effect)} | {parameters(effect)} |"


def page(effect: Effect) -> Iterator[str]:
    """The page of one effect."""
    about = " ".join((effect.__doc__ or "").split("\n\n")[0].split()).rstrip(".")
    yield f"# {effect.name}\n"
    yield f"Acts on {where(effect)}. [All effects, and what the symbols mean](../effects.md)\n"
    if PAGE.with_name("images").joinpath("effects", f"{effect.name}.png").is_file():
        yield f"![Its signature over speed, position and time](../images/effects/{effect.name}.png)\n"
    yield f"- Equation: {escaped(about)}"
    yield f"- Parameters: {parameters(effect)}"
    for p in (p for p in effect.parameters if p.about):
        yield f"    - `{p.name}`: {escaped(p.about)}"
    yield f"- Source: {escaped(effect.words.source)}"
    yield f"- Typical sign: {escaped(effect.words.shows)}"
    yield f"- Experiment that shows it best: {escaped(effect.words.reveal)}"
    yield f"- In MuJoCo: {escaped(effect.words.mujoco)}"
    if effect.search.contains:
        yield f"- Special cases: {links(effect.search.contains)}"
    if effect.search.twins:
        yield f"- Looks the same in many recordings: {links(effect.search.twins)}"
    place = "@AXIS" if effect.locations else ""
    values = "".join(f" {p.name}={p.example:g}" for p in effect.parameters if not p.optional)
    yield f"\n```sh\nworkbench add MODEL.toml {effect.name}{place}{values} -o new.toml\n```"


def links(names: tuple[str, ...]) -> str:
    """Effects by name, each a link to its page."""
    return ", ".join(f"[`{name}`]({name}.md)" for name in names)


def where(effect: Effect) -> str:
    """Axis and location in words."""
    if not effect.locations:
        return "the whole machine"
    return "one axis, at its drive or its pin" if "joint" in effect.locations else "one axis, at its drive"


def parameters(effect: Effect) -> str:
    """Names with units; those that may be left out in brackets."""
    needed = ", ".join(named(p) for p in effect.parameters if not p.optional) or "none"
    more = ", ".join(named(p) for p in effect.parameters if p.optional)
    return f"{needed} ({more})" if more else needed


def named(parameter: Parameter) -> str:
    """A name with its unit."""
    return f"`{parameter.name}`" + (f" [`{parameter.unit}`]" if parameter.unit != "1" else "")


def escaped(text: str) -> str:
    """Text with what Markdown would take for marks made plain; names in backticks stay."""
    return "`".join(
        part if k % 2 else re.sub(r"([*_|<>])", r"\\\1", part) for k, part in enumerate(text.split("`"))
    )


if __name__ == "__main__":
    main()
