"""Draws the mermaid blocks of the pages for the site that is opened from disk; git hosts draw them anyway.

python docs/draw_diagrams.py      # into docs/images/diagrams; needs npm (for mermaid, once) and chromium

`docs/diagrams.py` puts the drawings into the pages. Colours are names of the site's own, so that one drawing
serves light and dark pages.
"""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from diagrams import FOLDER, blocks, drawing

PAGES = Path(__file__).parent
MERMAID = "11.17.2"
#: Colours that mermaid computes with, and what a page has in their place.
COLOURS = {
    "#010203": "var(--md-default-fg-color)",
    "#040506": "var(--md-code-bg-color)",
    "#070809": "var(--md-default-fg-color--light)",
    "#0a0b0c": "var(--md-default-bg-color)",
}
SETTINGS = {
    "startOnLoad": False,
    "theme": "base",
    "htmlLabels": False,
    "fontFamily": "Helvetica, Arial, sans-serif",
    "flowchart": {
        "htmlLabels": False, "nodeSpacing": 30, "rankSpacing": 30,
        "wrappingWidth": 360, "padding": 10,
    },
    "themeVariables": {
        "fontSize": "15px",
        **dict.fromkeys(("textColor", "primaryTextColor"), "#010203"),
        **dict.fromkeys(("secondaryTextColor", "tertiaryTextColor"), "#010203"),
        **dict.fromkeys(("mainBkg", "primaryColor", "secondaryColor", "tertiaryColor"), "#040506"),
        **dict.fromkeys(("lineColor", "primaryBorderColor", "nodeBorder", "transitionColor"), "#070809"),
        **dict.fromkeys(("background", "edgeLabelBackground"), "#0a0b0c"),
    },
}  # fmt: skip


def main() -> None:
    """Draws every block whose text is new, and removes drawings of blocks that are gone."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    texts = [text for page in sorted(PAGES.rglob("*.md")) for text in blocks(page.read_text())]
    for text in texts:
        if not drawing(text).is_file():
            drawing(text).write_text(drawn(text) + "\n")
            print(f"{drawing(text).relative_to(PAGES)}: {drawing(text).stat().st_size} bytes")
    for old in set(FOLDER.glob("*.svg")) - {drawing(text) for text in texts}:
        old.unlink()


def drawn(text: str) -> str:
    """The SVG that mermaid makes of a block, with colours by name."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        raise SystemExit("needs chromium")
    with tempfile.TemporaryDirectory(prefix="diagrams-") as name:
        page = Path(name) / "page.html"
        name_of_drawing = drawing(text).stem
        page.write_text(
            f"<meta charset=utf-8><pre id=out></pre><script src='{mermaid().as_uri()}'></script><script>"
            f"mermaid.initialize({json.dumps(SETTINGS)});"
            f"mermaid.render('{name_of_drawing}', {json.dumps(text)})"
            ".then((d) => { document.getElementById('out').textContent = d.svg; })</script>"
        )
        quiet = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={name}/profile")
        done = subprocess.run(
            [browser, *quiet, "--virtual-time-budget=20000", "--dump-dom", page.as_uri()],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    found = re.search(r'<pre id="out">(.+?)</pre>', done.stdout, re.DOTALL)
    if found is None:
        raise SystemExit(f"mermaid made nothing of\n{text}")
    svg = html.unescape(found[1])
    for colour, named in COLOURS.items():
        red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
        svg = svg.replace(colour, named).replace(f"rgb({red}, {green}, {blue})", named)
    return svg


def mermaid() -> Path:
    """Mermaid as one file, from npm's registry into `build`, once."""
    folder = PAGES.parent / "build" / f"mermaid-{MERMAID}"
    script = folder / "package" / "dist" / "mermaid.min.js"
    if not script.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["npm", "pack", "--silent", f"mermaid@{MERMAID}"], cwd=folder, check=True)
        shutil.unpack_archive(folder / f"mermaid-{MERMAID}.tgz", folder, filter="data")
    return script.resolve()


if __name__ == "__main__":
    main()
