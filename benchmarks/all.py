"""All benchmarks that are ratios, one after another, printed and written into docs/benchmarks.md.

    python benchmarks/all.py --quick              # a small version of each
    python benchmarks/all.py                      # hours
    python benchmarks/all.py --only variants responses --no-page

What is compared is measured side by side in the same run, so that the machine hardly matters. A part that
needs what is not installed is left out, and keeps the figures that the page has.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from hidden_effects import read
from ratios import growth, loop, responses, selection, sysid, variants
from ratios.row import Part, Row, table

PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"
PARTS = {
    part.name: part
    for part in (sysid.PART, selection.PART, responses.PART, variants.PART, loop.PART, growth.PART)
}


def main() -> None:
    """Prints tables, and writes each part into the page as soon as it is measured."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer repeats, cases, minutes and axes")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--no-page", action="store_true", help="leave docs/benchmarks.md as it is")
    parser.add_argument(
        "--marks",
        type=Path,
        help="of hidden_effects.py with --others: for the part selection, run no more cases",
    )
    arguments = parser.parse_args()
    for part in (PARTS[name] for name in arguments.only):
        print(f"\n## {part.title}\n", flush=True)
        try:
            rows = _marked(arguments.marks) if arguments.marks and part is selection.PART else None
            found = table(rows or part.measure(arguments.quick))
        except ImportError as error:
            print(f"left out: {error}", flush=True)
            continue
        print(found, flush=True)
        if not arguments.no_page:
            words = f"--only {part.name}" + (" --quick" if arguments.quick and not rows else "")
            words += " --marks marks.jsonl" if rows else ""
            text = f"{found}\n\nFrom `python benchmarks/all.py {words}`."
            PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8"), part, text), encoding="utf-8")


def _marked(file: Path) -> list[Row]:
    return selection.rows(read([file]))


def replaced(page: str, part: Part, figures: str) -> str:
    """The page with a part's section between its marks, as new; the rest as it was."""
    start, end = marks(part)
    before, rest = page.split(start)
    after = rest.split(end)[1]
    more = f" `{part.command}` tells more." if part.command else ""
    return f"{before}{start}\n## {part.title}\n\n{part.about}{more}\n\n{figures}\n\n{end}{after}"


def marks(part: Part) -> tuple[str, str]:
    """What stands before and after a part on the page."""
    return f"<!-- {part.name}: written by benchmarks/all.py -->\n", f"<!-- end of {part.name} -->\n"


if __name__ == "__main__":
    main()
