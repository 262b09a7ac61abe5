"""Writes docs/gallery.md from the configs, and docs/commands.md from the command line.

    python docs/generated.py

`tests/test_docs.py` compares the stored pages with these.
"""

import inspect
import re
import sys
from pathlib import Path

import click

from rodsweep.cli import commands
from rodsweep.config.document.parsing import parsed_yaml

sys.path.insert(0, str(Path(__file__).parent))  # where a test loads this script
import figures  # noqa: E402

DOCS = Path(__file__).parent
CONFIGS = DOCS.parent / "configs"
TASKS = {
    "spectrum": "Spectra",
    "thresholds": "Thresholds",
    "phase_diagram": "Phase diagrams",
    "modes": "Modes",
    "limit_cycle": "Limit cycles",
    "criticality": "Criticality",
    "branch": "Branches of cycles",
}
"""Heading of the configs of each task."""
GALLERY = """# Gallery

Every figure of `configs/` with the number that it must show, the source of the number, and the commands
that compute and draw it in the clone. `mpiexec -n 2` before `rodsweep run` takes two cores. `make figures`
computes and draws all figures. A test asserts each number.

"""
COMMANDS = """# Commands

Every command of `rodsweep` with its options, as its help prints them. The
[how-to pages](howto/configs.md) explain when to use which.
"""


def gallery() -> str:
    """The page with all configs, task by task."""
    documents = {path: parsed_yaml(path.read_text(), path.name) for path in sorted(CONFIGS.glob("*.yaml"))}
    contents = "".join(f"- [{title}](#{title.lower().replace(' ', '-')})\n" for title in TASKS.values())
    parts = [GALLERY, contents]
    for task, title in TASKS.items():
        parts.append(f"\n## {title}\n\nThe task is described on the page [{task}](tasks/{task}.md).\n")
        drawn: dict[str, list[Path]] = {}
        for path, each in documents.items():
            if each["task"] == task:
                drawn.setdefault(str(figures.pictures(path.stem)), []).append(path)
        parts += [entry(paths, documents[paths[0]]["title"]) for paths in drawn.values()]
    return "".join(parts)


def entry(paths: list[Path], title: str) -> str:
    """Entry of the configs of one figure: title, figures, comment and commands of the first config."""
    path = paths[0]
    text = path.read_text()
    comment = re.match(r"(#.*\n)+", text)
    assert comment is not None
    told = re.sub(r"^# ?", "", comment[0], flags=re.MULTILINE).replace("\n# Expected", "\n\nExpected")
    told = told.replace("*", r"\*").replace("Expected:", "\n*Expected:*", 1)
    shown = "".join(f"![{title}]({picture})\n\n" for picture, _ in figures.pictures(path.stem))
    commands = "".join(f"    {command}\n" for command in figures.commands(path.stem))
    links = " and ".join(f"[{place(each)}](../{place(each)})" for each in paths)
    link = f"The config is {links}." if len(paths) == 1 else f"The configs are {links}."
    names = ", ".join(each.stem for each in paths)
    return f"\n### {title} ({names})\n\n{shown}{told}\n{link}\n\n{commands}"


def place(path: Path) -> str:
    """A path from the top of the clone."""
    return f"configs/{path.name}"


def command_line() -> str:
    """The page with all commands."""
    return COMMANDS + "".join(section(name, commands.commands[name]) for name in sorted(commands.commands))


def section(name: str, command: click.Command) -> str:
    """Section on one command: purpose, usage, table of options."""
    options = [each for each in command.params if isinstance(each, click.Option)]
    arguments = [each for each in command.params if isinstance(each, click.Argument)]
    usage = " ".join([f"rodsweep {name}", *(["[OPTIONS]"] if options else []), *map(typed, arguments)])
    rows = "".join(f"| {words(each)} | {described(each)} |\n" for each in options)
    table = f"\n| option | meaning |\n| --- | --- |\n{rows}" if rows else ""
    help_text = inspect.cleandoc(command.help or "")  # Python 3.13 takes the indent off itself
    return f"\n## rodsweep {name}\n\n{help_text}\n\n```text\n{usage}\n```\n{table}"


def typed(argument: click.Argument) -> str:
    """Usage text of an argument; click's own text differs between releases."""
    kind = argument.type
    text = "|".join(kind.choices) if isinstance(kind, click.Choice) else str(argument.name).upper()
    text += "..." if argument.nargs < 0 else ""
    return text if argument.required else f"[{text}]"


def words(option: click.Option) -> str:
    """Names of an option, with a name for its value."""
    kind = option.type
    text = "|".join(kind.choices) if isinstance(kind, click.Choice) else kind.name.upper()
    value = "" if option.is_flag else f" {option.metavar or text}"
    names = ", ".join(f"`{name}`" for name in option.opts)
    return f"{names}{value}".replace("|", r"\|")


def described(option: click.Option) -> str:
    """Meaning of an option, with the default if the help shows one."""
    shown = f" Default: {option.default}." if option.show_default else ""
    return f"{option.help or ''}{shown}".replace("|", r"\|")


PAGES = {DOCS / "gallery.md": gallery, DOCS / "commands.md": command_line}
"""Function that gives the text of each generated page."""

if __name__ == "__main__":
    for page, text in PAGES.items():
        page.write_text(text())
