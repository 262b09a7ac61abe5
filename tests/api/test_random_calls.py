"""Random calls of Python and of the command: answers have no filler, refusals lead somewhere.

Some dozen calls here; RODSWEEP_CASES=N makes N times as many, the same ones every time (60: ten minutes).
"""

import os
import re
import warnings
from dataclasses import replace
from random import Random

import numpy as np
import pytest
from faults import calls
from printed import flaws_of_layout

import rodsweep as rs

MORE = int(os.environ.get("RODSWEEP_CASES", "1"))
ANSWERS, TABLES, FILES, COMMANDS = 20 * MORE, 4 * MORE, 2 * MORE, 12
"""Calls of Python; tables and figures of answers; sweeps; and commands on each of them."""
FILLER = re.compile(r"\bnan\b|<NA>|(?<![\w.(+])-1(?![\w.)])|\.\.\.|\bNone\b")
"""What no answer has: fill values, cut lists."""
INTERNAL = re.compile(
    r"Undefined|<class|object at 0x|NoneType|Traceback|np\.|float64|pydantic|validat|\[type=|Error\b|\bNone\b"
)
"""What no refusal has: words of the program, not of its user."""
COUNTED = ("mode", "crossing", "branch_point", "special", "harmonic", "multiplier_number")
"""Dimensions whose coordinate numbers the items."""
HINT = re.compile(r"unknown (?:key|attribute) '?([\w.]+)'?; did you mean ([\w., ]+)\?")


def refusal_of(call):
    """(what came of a call, the sentence of its refusal or ""); other exceptions are raised."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return getattr(getattr(rs, call.kind)(**call.rod), call.task)(**call.options), ""
        except rs.InputError as error:
            return None, str(error)


def unclear(sentence, given):
    """What is wrong with a refusal; empty if nothing is. given: the call as text."""
    if "\n" in sentence or len(sentence) > 400 or not sentence.isprintable():
        return "not one line that can be read"
    if found := INTERNAL.search(sentence):
        # what was typed is quoted
        return "" if found[0] in given else f"it says {found[0]!r}"
    return ""


def leads_astray(call, sentence):
    """What is wrong with a hint, which is followed; empty if it leads to a key that there is."""
    hint = HINT.search(sentence)
    if not hint:
        return ""
    wrong, *meant = (name.rpartition(".")[2] for name in (hint[1], *re.split(", | or ", hint[2])))
    if call.misspelt and call.misspelt[0] == wrong and call.misspelt[1] not in meant:
        return f"it means {' or '.join(meant)} by {wrong}"
    place = call.rod if wrong in call.rod else call.options
    for right in meant:
        again = dict(place)
        again[right] = again.pop(wrong)
        rod, options = (again, call.options) if place is call.rod else (call.rod, again)
        _, told = refusal_of(replace(call, rod=rod, options=options))
        if re.search(rf"unknown key ([\w.]+\.)?{right};", told):
            return f"the key that it means is unknown too: {told}"
    return ""


def flaws_of(answer):
    """What is wrong with an answer, each in words."""
    yield from flaws_of_layout(answer)
    whole = answer.table()
    html = (re.sub(r"<[^>]*>", " ", each._repr_html_()) for each in (answer, whole))
    for text in (repr(answer), repr(whole), *html):
        body = text.replace(answer.message, "").replace(answer.sentence, "")
        for line in body.splitlines():
            if (found := FILLER.search(line)) and not line.startswith("none: "):
                yield f"{found[0]!r} in {line!r}"
    if str(answer.status) not in list(type(answer.status)):
        yield f"status {answer.status!r}"
    for name in answer.lists:
        yield from flaws_of_list(answer, name)
    for name in answer.data.data_vars:
        value = getattr(answer, str(name))
        is_real = isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.size > 0
        if is_real and np.isnan(value).all() and "special" not in str(name):
            yield f"{name} is NaN all along"
        if isinstance(value, int) and value == -1:
            yield f"{name} is -1"
    dimension = answer.data.sizes.get("mode")
    if answer.status == "ok" and dimension and len(answer.modes) != dimension:
        yield f"{len(answer.modes)} modes of {dimension}"


def flaws_of_list(answer, name):
    """What is wrong with a list of an answer."""
    frame = getattr(answer, name)
    if len(frame) and not frame.notna().any(axis=1).all():
        yield f"{name} has a row without anything"
    if frame.index.name in COUNTED and frame.index.tolist() != list(range(1, len(frame) + 1)):
        yield f"{name} is numbered {frame.index.tolist()}"
    words = [column for column in frame if frame[column].dtype == object or "str" in str(frame[column].dtype)]
    for column in words:
        if {"none", "missing", ""} & set(frame[column].dropna()):
            yield f"{column} has a word for nothing"
    table = rs.table(answer, name)
    if len(table) != len(frame) or not set(frame) <= set(table):
        yield f"rs.table has another {name}"


@pytest.mark.parametrize("seed", range(ANSWERS))
def test_an_answer_or_a_refusal_says_what_it_should(seed):
    call = calls.call(Random(f"answer {seed}"))
    answer, sentence = refusal_of(call)
    flaws = [unclear(sentence, str(call)), leads_astray(call, sentence)] if sentence else flaws_of(answer)
    assert not [flaw for flaw in flaws if flaw], (str(call), sentence)
    if call.misspelt:
        assert sentence, f"{call} takes {call.misspelt[0]}"


@pytest.mark.parametrize("seed", range(TABLES))
def test_tables_and_figures_of_answers_are_made_or_refused(seed):
    rng = Random(f"tables {seed}")
    call = calls.call(rng)
    answer, _ = refusal_of(call)
    if answer is None:
        return
    asked = calls.asked_of_a_result(rng, sorted(map(str, answer.data.variables)))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            made = asked.of(rs, answer)
    except rs.InputError as error:
        assert not unclear(str(error), str(asked)), (str(call), str(asked), str(error))
        hint = re.search(r"'([^']*)'; did you mean (\w+)", str(error))
        assert not hint or hint[2] in (*answer.lists, "points", *map(str, answer.data.variables)), str(error)
    else:
        assert "..." not in getattr(made, "shown", ""), made.shown


@pytest.mark.long
@pytest.mark.parametrize("seed", range(FILES))
def test_commands_on_a_result_say_what_they_should(seed, command):
    rng = Random(f"commands {seed}")
    text = calls.config(rng)
    command.write("c.yaml", text)
    (command.directory / "sub").mkdir()
    made = command("run", "c.yaml", "-q")
    if made.returncode == 2:  # a combination that is not allowed
        assert not unclear(made.stderr.strip(), text)
        return
    assert made.returncode in (0, 1), (text, made.stderr)
    for _ in range(COMMANDS):
        words = calls.words(rng, "c.h5", "c.yaml")
        before = {path: path.stat().st_mtime_ns for path in command.directory.rglob("*") if path.is_file()}
        done = command(*words.words)
        where = (text, str(words), done.stderr, done.stdout[-2000:])
        assert done.returncode in (0, 1, 2, 3, 75), where
        assert "Traceback" not in done.stderr + done.stdout, where
        if done.returncode in (2, 3):
            assert (done.stderr.count("\n"), done.stdout) == (1, ""), where
            assert not unclear(done.stderr.strip(), str(words)), where
            assert all(path.stat().st_mtime_ns == time for path, time in before.items()), where
        elif words.words[0] in ("show", "check"):
            assert not [line for line in done.stdout.splitlines() if re.search(r"\bnan\b|\bNone\b", line)], (
                where
            )


@pytest.mark.parametrize(
    ("sentence", "says"),
    [
        ("a = nan is PydanticUndefined", "it says 'Undefined'"),
        ("one\ntwo", "not one line that can be read"),
        ("value is not NoneType", "it says 'NoneType'"),
        ("F = 3 is not allowed", ""),
    ],
)
def test_an_unclear_refusal_is_seen(sentence, says):
    assert unclear(sentence, "rs.Rod()") == says


def test_a_hint_that_leads_astray_is_seen():
    call = calls.Call("spectrum", {"F": 1, "k1": 200, "k2": 1e4, "gamma3": 0}, {"mods": 3}, ("mods", "modes"))
    assert leads_astray(call, refusal_of(call)[1]) == ""
    assert leads_astray(call, "unknown key spectrum.mods; did you mean nodes?") == "it means nodes by mods"
