"""Configs made bad: by rule, for every key, and at random from a seed.

A config is a tree of dictionaries, lists and plain values into which any text of YAML may be put as it is.
"""

import copy
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from random import Random
from typing import Any

from pydantic import BaseModel
from ruamel.yaml import YAML

from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK

from . import wrong

Keys = tuple[str, ...]


@dataclass(frozen=True)
class Case:
    """One bad input: the file, what `--set` says beside it, and what must come of it."""

    name: str
    config: bytes
    overrides: tuple[str, ...] = ()
    refused: bool = True
    """Whether it must be refused; else it may be valid, as some mutations are harmless."""
    says: str = ""
    """What the refusal must say."""


class Verbatim(str):
    """A piece of YAML as it is to be written."""


def tree_of(path: Path) -> dict:
    """A config as a tree."""
    return YAML(typ="safe", pure=True).load(path.read_text())


def yaml_of(value: Any) -> str:
    """A tree as YAML on one line."""
    if isinstance(value, Verbatim):
        return value
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {yaml_of(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(yaml_of, value)) + "]"
    return json.dumps(value).replace("Infinity", ".inf")


def text_of(tree: dict) -> bytes:
    """A tree as the text of a config, each of the outermost keys on its own line."""
    text = "".join(f"{key}: {yaml_of(value)}\n" for key, value in tree.items())
    return text.encode(errors="surrogatepass")


def is_section(field: Any) -> bool:
    """Whether a key of the config has keys below it."""
    return isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel)


def keys_of(tree: dict) -> list[Keys]:
    """Every key that the tree has or might have; those of its ranges too."""
    found: list[Keys] = []
    for name, field in CONFIG_CLASSES_BY_TASK[tree["task"]].model_fields.items():
        found.append((name,))
        if is_section(field):
            found += [(name, inner) for inner in field.annotation.model_fields]
    for name, value in tree["parameters"].items():
        if isinstance(value, dict):
            found += [("parameters", name, inner) for inner in value]
    return found


def at(tree: dict, keys: Keys) -> Any:
    """The value at a place; None where there is none."""
    node: Any = tree
    for name in keys:
        node = node.get(name) if isinstance(node, dict) else None
    return node


def with_value(tree: dict, keys: Keys, value: Any) -> dict:
    """The tree with another value at a place, which is made where it is missing."""
    tree = copy.deepcopy(tree)
    node = tree
    for name in keys[:-1]:
        node[name] = node.get(name) or {}
        node = node[name]
    node[keys[-1]] = value
    return tree


def without(tree: dict, keys: Keys) -> dict:
    """The tree without a key."""
    tree = copy.deepcopy(tree)
    (at(tree, keys[:-1]) or {}).pop(keys[-1], None)
    return tree


def renamed(tree: dict, keys: Keys, name: str) -> dict:
    """The tree with another name for a key, in its place."""
    tree = copy.deepcopy(tree)
    node = at(tree, keys[:-1])
    entries = [(name if key == keys[-1] else key, value) for key, value in node.items()]
    node.clear()
    node.update(entries)
    return tree


def refused_values(tree: dict, keys: Keys) -> list[str]:
    """The texts of YAML that may not be the value of a key."""
    field = CONFIG_CLASSES_BY_TASK[tree["task"]].model_fields[keys[0]]
    if len(keys) == 3:
        return wrong.NEVER + wrong.NO_NUMBER
    if len(keys) == 1 and is_section(field):
        return wrong.SECTION + [text for text in wrong.NEVER if text != "{}" or keys == ("parameters",)]
    if len(keys) == 2:
        field = field.annotation.model_fields[keys[1]]
    harmless = {"true"} if field.annotation is bool else {"nan"} if field.annotation is str else set()
    if keys == ("title",):
        harmless |= {"12:30:45", *(text for text in wrong.NEVER if set(text) == {"1", ":"})}
    by_type = {int: wrong.WHOLE, bool: wrong.FLAG}.get(field.annotation, [])
    return wrong.FOR_KEY.get(keys, by_type) + [text for text in wrong.NEVER if text not in harmless]


def wrong_values(tree: dict) -> Iterator[Case]:
    """Every key with everything that it may not have, in the file."""
    for keys in keys_of(tree):
        for value in refused_values(tree, keys):
            refused = value not in wrong.NOTHING or keys not in wrong.MAY_BE_NOTHING
            text = text_of(with_value(tree, keys, Verbatim(value)))
            yield Case(f"{'.'.join(keys)}: {value[:40]!a}", text, refused=refused)


def wrong_overrides(tree: dict) -> Iterator[Case]:
    """Every key with everything that it may not have, by `--set`; and overrides that are none."""
    text = text_of(tree)
    for keys in keys_of(tree):
        for value in refused_values(tree, keys):
            if "\0" not in value:  # no command line holds it
                refused = value not in wrong.NOTHING or keys not in wrong.MAY_BE_NOTHING
                override = f"{'.'.join(keys)}={value}"
                yield Case(f"--set {override[:60]!a}", text, (override,), refused)


def odd_overrides(tree: dict) -> Iterator[Case]:
    """Overrides that are no key=value, or whose key leads nowhere."""
    text = text_of(tree)
    for override in wrong.OVERRIDES:
        yield Case(f"--set {override[:60]!a}", text, (override,))
    yield Case("a thousand overrides", text, tuple(f"a{i}=3" for i in range(1000)))
    yield Case("one override a thousand times", text, ("accuracy=1e-8",) * 1000, refused=False)
    yield Case("overrides that undo each other", text, ("parameters=3", "parameters.F=3"))


def misspelled(name: str, rng: Random) -> str:
    """A name with a letter left out, doubled, replaced or in another case, two swapped, or more beside."""
    i = rng.randrange(len(name))
    return rng.choice(
        [
            name[:i] + name[i + 1 :] or "q",
            name[: i + 1] + name[i:],
            name[:i] + "q" + name[i + 1 :],
            name[:i] + name[i].swapcase() + name[i + 1 :],
            name[:i] + name[i + 1 : i + 2] + name[i] + name[i + 2 :],
            f"{name}_",
            f'" {name}"',
            f"{name}-é",
        ]
    )


def odd_keys(tree: dict, rng: Random) -> Iterator[Case]:
    """Keys that are unknown, misspelled, given twice or missing, of another task, or no words at all."""
    places = [keys for keys in keys_of(tree) if at(tree, keys) is not None]
    for keys in places:
        dotted, name, value = ".".join(keys), keys[-1], yaml_of(at(tree, keys))
        odd = misspelled(name, rng)
        if odd != name:
            says = odd.strip('"').strip()
            yield Case(f"{dotted} misspelled as {odd}", text_of(renamed(tree, keys, odd)), says=says)
        between = "\n" if len(keys) == 1 else ", "
        twice = renamed(tree, keys, f"{name}: {value}{between}{name}")
        yield Case(f"{dotted} twice", text_of(twice), says=name)
        optional = keys[0] in ("title", "accuracy", tree["task"]) or name in (
            "spacing",
            "gamma1",
            *wrong.OPTIONAL_OF_ARM,
        )
        yield Case(f"{dotted} missing", text_of(without(tree, keys)), refused=not optional)
    for keys in [(), *(keys for keys in places if isinstance(at(tree, keys), dict))]:
        for key in wrong.KEYS:
            yield Case(f"{'.'.join(keys)} with {key[:40]!a}", text_of(with_value(tree, (*keys, key), 1)))
    for task in CONFIG_CLASSES_BY_TASK:
        if task != tree["task"]:
            for value in ("{}", "3", "~", "{modes: 3}"):
                yield Case(f"{task}: {value}", text_of(tree | {task: Verbatim(value)}), says=task)
            yield Case(f"task: {task}", text_of(tree | {"task": task}), refused=False)


def many(count: int, line: Callable[[int], str]) -> str:
    return "".join(line(i) for i in range(count))


def bomb(levels: int) -> str:
    """A billion laughs: each level names the one below nine times."""
    first = "a0: &a0 [lol, lol]\n"
    return first + many(levels, lambda i: f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 9)}]\n")


def explosions(tree: dict) -> Iterator[Case]:
    """Small texts that would be large trees, or deep ones, or code; and large texts."""
    bad = {
        "billion laughs": bomb(30),
        "billion laughs, merged": "a0: &a0 {F: 1}\n"
        + many(20, lambda i: f"a{i + 1}: &a{i + 1} {{<<: [*a{i}, *a{i}]}}\n"),
        "a list that holds itself": "a: &a [*a]\n",
        "a mapping that is its own key": "&a {? *a : 1}\n",
        "merge key": "<<: {accuracy: 1.0e-6}\n",
        "merge key of an alias": "a: &a {accuracy: 1.0e-6}\n<<: *a\n",
        "merge list": "<<: [{title: a}, {title: b}]\n",
        "deep list": "a: " + "[" * 5000 + "]" * 5000,
        "deep open list": "a: " + "[" * 90_000,
        "deep mapping": "a: " + "{a: " * 5000 + "1" + "}" * 5000,
        "deep pairs": "a: " + "[a: " * 5000,
        "deep mixture": "a: " + "[{a: " * 5000,
        "deep dashes": "- " * 40_000,
        "deep questions": "? " * 40_000,
        "deep blocks": many(400, lambda i: " " * i + "a:\n"),
        "deep block lists": "a:\n" + many(400, lambda i: " " * i + "-\n"),
        "deep keys": "{" * 5000 + "}: 1" * 5000,
        "a second document": "---\na: 1\n",
        "three documents": "---\na: 1\n---\nb: 1\n",
        "more after the end": "...\na: 1\n",
        "directive": "%YAML 1.1\n---\n",
        "tag directive": "%TAG ! tag:yaml.org,2002:python/\n---\n",
        "unknown directive": "%FOO bar\n---\n",
        "tag of the document": "--- !!python/object:os.system\n",
        "thousands of keys": many(9000, lambda i: f"k{i}: 1\n"),
        "too many keys": many(80_000, lambda i: f"k{i}: 1\n"),
        "thousands of tags": many(3000, lambda i: f"k{i}: !!python/name:os.system\n"),
        "thousands of anchors": many(2000, lambda i: f"k{i}: &k{i} 1\n"),
        "thousands of equal keys": "k: 1\n" * 9000,
        "too long a text": "a: " + "x" * 1_000_000,
        "a long text": "a: " + "x" * 90_000,
        "many words": "a: " + "x " * 10_000,
        "many quoted words": 'a: "' + "x " * 10_000 + '"',
        "many escapes": 'a: "' + "\\x41" * 20_000 + '"',
        "many folded lines": "a: >\n" + " x\n" * 10_000,
        "many quotes": "a: " + "'" * 89_999,
        "a long integer": f"a: {wrong.LONG_INTEGER}\n",
        "a long hexadecimal": f"a: 0x{wrong.LONG_INTEGER}\n",
        "a long fraction": f"a: 0.{wrong.LONG_INTEGER}\n",
        "a long date": f"a: 2001-01-01 1:1:1.{wrong.LONG_INTEGER}\n",
        "a long tag": f"a: !{'t' * 90_000} 3\n",
        "a long alias": f"a: *{'t' * 90_000}\n",
        "a long anchor": f"a: &{'t' * 90_000} 3\n",
        "a long key": f"{'k' * 90_000}: 3\n",
        "a long complex key": f"? {'k' * 90_000}\n: 3\n",
        "a long list": f"a: [{', '.join(map(str, range(4000)))}]\n",
    }
    for alone, (name, text) in zip(cycle([True, False]), bad.items(), strict=False):
        content = text.encode() if alone else text_of(tree) + text.encode()
        yield Case(f"{name}, {'alone' if alone else 'behind the rest'}", content)
    harmless = {
        "a long comment": "# " + "x" * 80_000 + "\n",
        "many comments": "# x\n" * 20_000,
        "many empty lines": "\n" * 80_000,
        "the end of the document": "...\n",
        "many spaces": " " * 80_000 + "\n",
    }
    for name, text in harmless.items():
        yield Case(f"{name}, behind the rest", text_of(tree) + text.encode(), refused=False)
    numbers = ", ".join(map(str, range(1, 4000)))
    for name in tree["parameters"]:
        text = text_of(with_value(tree, ("parameters", name), Verbatim(f"[{numbers}]")))
        yield Case(f"{name}: a long list", text, refused=False)


def odd_bytes(tree: dict, rng: Random) -> Iterator[Case]:
    """What is no text, or text of another kind."""
    data = text_of(tree)
    for name in ("utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp500"):
        yield Case(f"encoded in {name}", data.decode().encode(name))
    bad = {
        "NUL": b"\0", "BEL": b"\7", "DEL": b"\x7f", "invalid UTF-8": b"\xff", "cut UTF-8": b"\xe2\x82",
        "overlong UTF-8": b"\xc0\x80", "surrogate": b"\xed\xa0\x80", "beyond Unicode": b"\xf4\x90\x80\x80",
        "escape": b"\x1b[31m", "noncharacter": "\ufffe".encode(),
    }  # fmt: skip
    harmless = {
        "byte-order mark": "\ufeff".encode(), "next line": "\x85".encode(),
        "line separator": "\u2028".encode(), "right to left": "\u202e".encode(), "tab": b"\t",
        "carriage return": b"\r", "no-break space": "\xa0".encode(),
    }  # fmt: skip
    for name, piece in (bad | harmless).items():
        for _ in range(2):
            i = rng.randrange(len(data))
            yield Case(f"{name} at {i}", data[:i] + piece + data[i:], refused=name in bad)
    yield Case("lines end in CR LF", data.replace(b"\n", b"\r\n"), refused=False)
    yield Case("lines end in CR", data.replace(b"\n", b"\r"), refused=False)
    yield Case("begins with a byte-order mark", b"\xef\xbb\xbf" + data, refused=False)
    for name, content in {
        "empty": b"", "a line end": b"\n", "a comment": b"# nothing\n", "NULs": bytes(5000),
        "HDF5": b"\x89HDF\r\n\x1a\n" + rng.randbytes(3000), "PNG": b"\x89PNG\r\n\x1a\n" + rng.randbytes(3000),
        "random ASCII": bytes(rng.choices(range(32, 127), k=2000)),
        "random indicators": bytes(rng.choices(b"-?:,[]{}#&*!|>'\"%@` \n", k=2000)),
    }.items():  # fmt: skip
        yield Case(name, content)
    for size in (1, 10, 1000, 90_000):
        yield Case(f"{size} random bytes", rng.randbytes(size))


def random_tree(tree: dict, rng: Random) -> Case:
    """Some keys left out, exchanged, or with values of a plausible kind: often valid, and then extreme."""
    keys_there, done = keys_of(tree), []
    for _ in range(rng.randint(1, 4)):
        keys, other = rng.choice(keys_there), rng.choice(keys_there)
        if not all(isinstance(at(tree, keys[:depth]) or {}, dict) for depth in range(len(keys))):
            continue
        what = rng.random()
        if what < 0.6:
            number = f"{rng.choice([-1, 1]) * 10 ** rng.uniform(-300, 300):.3g}"
            value = rng.choice([rng.choice(wrong.PLAUSIBLE), number, str(rng.randint(-5, 999))])
            tree = with_value(tree, keys, Verbatim(value))
            done.append(f"{'.'.join(keys)}: {value}")
        elif what < 0.8:
            tree = without(tree, keys)
            done.append(f"no {'.'.join(keys)}")
        else:
            tree = with_value(tree, keys, copy.deepcopy(at(tree, other)))
            done.append(f"{'.'.join(keys)} as {'.'.join(other)}")
    return Case("; ".join(done), text_of(tree), refused=False)


def random_text(text: bytes, rng: Random) -> Case:
    """Characters and lines changed, left out, doubled, moved; or the text cut."""
    data = bytearray(text)
    for _ in range(rng.randint(1, 5)):
        i = rng.randrange(len(data) + 1)
        j = min(len(data), i + rng.choice([1, 2, 5, 40]))
        what = rng.randrange(7)
        if what == 0:
            del data[i:j]
        elif what == 1:
            data[i:i] = data[i:j]
        elif what == 2:
            data[i:j] = bytes(rng.choices(b"-?:,[]{}#&*!|>'\"%@` \n\t0123456789.e+_xnaif~<=", k=j - i))
        elif what == 3:
            data[i : i + 1] = rng.randbytes(1)
        elif what == 4:
            lines = bytes(data).splitlines(keepends=True)
            rng.shuffle(lines)
            data = bytearray(b"".join(lines))
        elif what == 5:
            k = rng.randrange(len(data) + 1)
            data[k:k] = data[i:j]
        elif rng.random() < 0.3:
            del data[i:]
    return Case(f"random text {bytes(data[-60:])!r}", bytes(data), refused=False)
