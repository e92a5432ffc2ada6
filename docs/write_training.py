"""Writes the tables in training.md from the code's tasks.

python docs/write_training.py            # rewrites the tables
python docs/write_training.py --check    # exit code 1 where they are not current
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from workbench.effects import load_model
from workbench.training import LEG_RANDOMISATION, TASKS, Randomisation, Task, make_machine
from workbench.training.probe import sizes

PAGE = Path(__file__).with_name("training.md")
START, END = "<!-- tables: written by write_training.py -->\n", "<!-- end of tables -->\n"


def main() -> None:
    """Rewrites or checks the page."""
    old = PAGE.read_text(encoding="utf-8")
    new = page(old)
    if "--check" in sys.argv[1:]:
        sys.exit(None if new == old else "docs/training.md is not current: run python docs/write_training.py")
    PAGE.write_text(new, encoding="utf-8")


def page(old: str) -> str:
    """The page with fresh tables between its marks."""
    before, rest = old.split(START)
    after = rest.split(END)[1]
    return before + START + "\n" + "\n".join(tables()) + "\n\n" + END + after


def tables() -> Iterator[str]:
    """The tables of all tasks: observations, rewards, and the differences between worlds."""
    for task in TASKS.values():
        yield f"## {task.name}\n"
        yield f"{task.about} Episodes of {task.episode_s:g} s; an action of 1 is {task.action_scale:g} rad.\n"
        yield from observations(task)
        yield "\n| reward | weight per second | what it is |\n|---|---|---|"
        for term in task.rewards:
            yield f"| `{term.name}` | {term.weight:g} | {escaped(term.about)} |"
        yield ""
    yield "## Randomisation\n"
    yield "| links | centre of mass [m] | inertia scale | mass scale |\n|---|---|---|---|"
    for name, links in LEG_RANDOMISATION.items():
        if links is None:
            yield f"| `{name}` | | | |"
        else:
            yield f"| `{name}` | ±{links.centre:g} | {span(links.inertia)} | {span(links.mass)} |"
    r = Randomisation()
    own = ", ".join(f"{task.name}: `{task.randomisation}`" for task in TASKS.values())
    yield (
        f"\nEvery world of a quadruped also has its own friction ({span(r.friction)}), additional trunk "
        f"mass ({span(r.base_mass)} kg) and shift of the trunk's centre of mass (±{r.base_centre:g} m). "
        f"It is pushed by up to {r.push:g} m/s about every {r.push_every_s:g} s. Identified parameters of "
        "effects are drawn with their standard deviations. The range of the links is that of the task "
        f"({own}), or of `--legs`."
    )


def observations(task: Task) -> Iterator[str]:
    """The policy's input, and what the critic sees beside it."""
    machine = make_machine(task.machine, load_model("leg"))
    yield "| observation | numbers | scale | noise (±) | what it is |\n|---|---|---|---|---|"
    for private in (False, True):
        table = task.privileged if private else task.observations
        for entry, size in zip(table, sizes(task, machine, private), strict=True):
            about = escaped(entry.about) + (" Critic only." if private else "")
            yield f"| `{entry.name}` | {size} | {entry.scale:g} | {entry.noise:g} | {about} |"


def span(pair: tuple[float, float]) -> str:
    """Two numbers as an interval."""
    return f"{pair[0]:g} to {pair[1]:g}"


def escaped(text: str) -> str:
    """Text for a cell of a table."""
    return text.replace("|", "\\|")


if __name__ == "__main__":
    main()
