"""The command `arm`: an arm in SI units, its numbers and its verdict, printed."""

from rich.console import Console
from rich.table import Table

from ..errors import InputError
from .arm_options import OPTIONS


def describe_arm(given: dict[str, str | None], poisson: float) -> None:
    """Prints verdict, numbers and checks. InputError, naming the option, where a quantity is none."""
    from ..verdict.arm import Arm

    quantities = {name: text for name, text in given.items() if text is not None}
    try:
        arm = Arm(**quantities, poisson=poisson)
    except InputError as error:
        raise InputError(f"--{_as_option(str(error))}") from None
    report = arm.report()
    console = Console(highlight=False)
    for number, sentence in enumerate(report.verdict):
        console.print(sentence, markup=False, style="bold" if number == 0 else "")
    table = Table("number", "value", "formula", "source", box=None, pad_edge=False)
    for row in report.rows:
        table.add_row(*row)
    console.print()
    console.print(table)
    console.print("In brackets: the range over drag, which is known by factors only.\n")
    for check in report.checks:
        prefix = "" if check.fine else "warning: "
        console.print(prefix + check.sentence, markup=False, style="" if check.fine else "yellow")


def _as_option(sentence: str) -> str:
    """A sentence whose first word is a quantity, with the name of its option."""
    name = next((name for name in OPTIONS if sentence.startswith(name)), "")
    return name.replace("_", "-") + sentence[len(name) :]
