"""What a new user meets first: help without a command, completion by the shell, a run that keeps quiet."""

import pytest

from rodsweep.cli import commands

SPECTRA = "task: spectrum\nparameters: {F: [20, 40], k1: 200, k2: 1.0e4, gamma3: 1.0e-4}\n"


def test_no_command_prints_help_line_by_line(command):
    done = command()
    assert (done.returncode, done.stdout) == (2, "")
    lines = [line.split() for line in done.stderr.splitlines()]
    assert lines[0][:3] == ["Usage:", "rodsweep", "[OPTIONS]"]
    assert [words[0] for words in lines if words and words[0] in commands.commands] == sorted(
        commands.commands
    )
    assert done.stderr.strip() == command("--help").stdout.strip()


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("rodsweep pl", "plot"), ("rodsweep run --fr", "--fresh"), ("rodsweep exp", "export")],
)
def test_the_shell_completes_commands_and_options(command, typed, offered):
    words = {"COMP_WORDS": typed, "COMP_CWORD": str(len(typed.split()) - 1)}
    done = command(_RODSWEEP_COMPLETE="bash_complete", **words)
    assert (done.returncode, done.stderr) == (0, "")
    assert f"plain,{offered}" in done.stdout.splitlines()


def test_an_unknown_command_is_answered_with_the_closest_or_with_all(command):
    misspelt, foreign = command("shwo"), command("open")
    assert (misspelt.returncode, foreign.returncode) == (2, 2)
    assert misspelt.stderr == "rodsweep: unknown command shwo; did you mean show?\n"
    names = ", ".join(sorted(commands.commands))
    assert foreign.stderr == f"rodsweep: unknown command open; the commands are {names}\n"


@pytest.mark.parametrize(
    ("words", "radius"),
    [
        (("arm", "--diameter", "1 cm"), "--radius"),
        (("arm", "--inner-diameter=1 cm"), "--inner-radius"),
        (("portrait", "--tip_diameter", "1 cm"), "--tip-radius"),
    ],
)
def test_the_option_of_a_diameter_is_answered_with_that_of_the_radius(command, words, radius):
    refused = command(*words)
    option = words[1].partition("=")[0]
    expected = f"rodsweep: unknown option {option}; give {radius}, half of it\n"
    assert (refused.returncode, refused.stderr) == (2, expected)
    assert command("arm", "--colour", "red").stderr.startswith("rodsweep: No such option")


def test_options_are_named_where_an_arm_is_too_short(command):
    quantities = ("--young", "1 MPa", "--viscosity", "1 Pa s")
    refused = command("arm", "--length", "1 cm", "--radius", "5 m", *quantities)
    assert "--length = '1 cm' is 0.002 radii, with --radius = '5 m'; the drag" in refused.stderr


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_its_script(command, shell):
    done = command.afresh(_RODSWEEP_COMPLETE=f"{shell}_source")
    assert done.returncode == 0
    assert f"_RODSWEEP_COMPLETE={shell}_complete" in done.stdout


@pytest.mark.long
@pytest.mark.parametrize("ranks", [0, 2])
def test_a_quiet_run_says_nothing(command, ranks):
    command.write("c.yaml", SPECTRA)
    for _ in range(2):  # the second has nothing to do
        done = command("run", "c.yaml", "--quiet", ranks=ranks)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert "2 of 2" in command("run", "c.yaml", "--fresh").stdout


def test_a_quiet_run_says_what_is_amiss(command):
    """The onset F* cannot be had to 1e-12, and a key is misspelt."""
    config = "task: spectrum\nparameters: {F: [10, 20.0080206921031], k1: 1e4, k2: 1e4, gamma3: 1e-4}\n"
    command.write("c.yaml", config + "accuracy: 1e-12\n")
    done = command("run", "c.yaml", "-q")
    first, second, third = done.stdout.splitlines()
    assert done.returncode == 1
    assert first == "c.h5: 1 ok, 1 accuracy_not_reached"
    assert "F = 20.0080206921031" in second
    assert "says what each status means" in third
    command.write("e.yaml", config.replace("F:", "G:"))
    refused = command("run", "e.yaml", "-q")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert "unknown key parameters.G" in refused.stderr
