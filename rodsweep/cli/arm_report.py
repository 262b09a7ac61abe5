"""The command `arm`: an arm in SI units, its numbers and its verdict, printed."""

from rich.console import Console

from ..errors import InputError
from .arm_options import OPTIONS


def describe_arm(given: dict[str, str | None], poisson: float) -> None:
    """Prints verdict, numbers and checks. InputError, naming the option, where a quantity is none."""
    from ..verdict.arm import OVER_DRAG, Arm, folded

    quantities = {name: text for name, text in given.items() if text is not None}
    try:
        arm = Arm(**quantities, poisson=poisson)
    except InputError as error:
        raise InputError(f"--{_as_option(str(error))}") from None
    report = arm.report()
    console = Console(highlight=False, soft_wrap=True)
    for number, sentence in enumerate(report.verdict):
        console.print(folded(sentence), markup=False, style="bold" if number == 0 else "")
    console.print("", *report.table(), OVER_DRAG, "", sep="\n", markup=False)
    for check in report.checks:
        console.print(folded(check.told), markup=False, style="" if check.fine else "yellow")


def _as_option(sentence: str) -> str:
    """A sentence whose first word is a quantity, with the name of its option."""
    name = next((name for name in OPTIONS if sentence.startswith(name)), "")
    return name.replace("_", "-") + sentence[len(name) :]
