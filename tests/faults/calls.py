"""Random calls of the Python interface and of the command, with mistakes in them."""

from dataclasses import dataclass, field
from random import Random
from typing import Any

from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.post.tables.table_names import BRANCHES_TABLE, GRID_TABLE, POINTS_TABLE, TABLE_NAMES

TASKS = ("spectrum", "thresholds", "modes", "limit_cycle", "criticality", "branch")
"""The tasks of one rod."""
OPTIONS: dict[str, dict[str, list[Any]]] = {
    "spectrum": {
        "modes": [1, 2, 3, 5, 8],
        "vectors": [True],
        "nodes": [3, 5],
        "certify": [False],
        "longitudinal": [True],
        "follow": [False],
    },
    "thresholds": {"F_max": [1e-3, 10, 30, 60, 120], "crossings": [1, 2, 3], "certify": [False]},
    "modes": {"modes": [1, 3, 5], "nodes": [3, 5], "growth": [False], "certify": [False]},
    "limit_cycle": {
        "harmonics": [1, 3],
        "samples": [4],
        "shapes": [2],
        "nodes": [5],
        "transient": [5],
        "time": ["tau1"],
        "amplitude": [0.1],
    },
    "criticality": {"F_max": [20, 45, 80], "crossings": [1, 2]},
    "branch": {"start": [10.0], "stop": [30.0, 45.0], "cycles": [5], "special": [1, 2], "along": ["F"]},
}
"""Values of options that cost little; an option is left out as often as not."""
ACCURACY = {"limit_cycle": 1e-3, "branch": 1e-3}
WRONG_VALUES = [
    "many",
    -1,
    0,
    1.5,
    None,
    True,
    [],
    [1, 2],
    {},
    float("nan"),
    float("inf"),
    10**400,
    "",
    "1e-3",
]
ENDINGS = ["", ".h5", ".csv", ".tsv", ".png", ".pdf", ".gif", ".xlsx", ".txt", ".md", ".nc", ".json", ".H5"]


@dataclass(frozen=True)
class Call:
    """A call of a task of a rod: keywords of the rod, of the task; what is wrong in them, if anything."""

    task: str
    rod: dict[str, Any]
    options: dict[str, Any]
    misspelt: tuple[str, str] | None = None
    """(the key that is written, the one that is meant)."""
    kind: str = "Rod"
    """Rod or Arm."""

    def __str__(self) -> str:
        given, asked = (", ".join(f"{k}={v!r}" for k, v in d.items()) for d in (self.rod, self.options))
        return f"rs.{self.kind}({given}).{self.task}({asked})"


@dataclass(frozen=True)
class Words:
    """A call of the command."""

    words: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return "rodsweep " + " ".join(self.words)


@dataclass(frozen=True)
class Asked:
    """A table or a figure of a result: `rs.table` or `rs.plot` with these keywords."""

    name: str
    keywords: dict[str, Any]

    def of(self, module: Any, result: Any) -> Any:
        """What comes of it."""
        return getattr(module, self.name)(result, **self.keywords)

    def __str__(self) -> str:
        return f"rs.{self.name}(result, {', '.join(f'{k}={v!r}' for k, v in self.keywords.items())})"


def asked_of_a_result(rng: Random, variables: list[str]) -> Asked:
    """A table or a figure, of columns and with choices that there are or are not."""
    if rng.random() < 0.6:
        names = [*variables, *variables, "k3", "crossing", "", misspelt(rng, rng.choice(variables))]
        columns = rng.sample(names, rng.choice([1, 2, 3]))
        table = rng.choice([None, *TABLE_NAMES.values(), GRID_TABLE, BRANCHES_TABLE, POINTS_TABLE, "mode", 3])
        return Asked(
            "table", rng.choice([{"columns": columns}, {"name": table}, {"name": table, "columns": columns}])
        )
    what = rng.choice([None, None, "cycle", "amplitude", "maps", "energy", "transient", "heat"])
    choices = {
        "what": what,
        "points": rng.choice([(), 1, 0, [1], [2, 3]]),
        "width": rng.choice([None, "single", "x"]),
    }
    return Asked("plot", {key: value for key, value in choices.items() if rng.random() < 0.7})


def drawn_rod(rng: Random) -> dict[str, Any]:
    """The parameters of a rod, some of them in a limit."""
    k1, k2 = (rng.choice([10 ** rng.uniform(1.5, 5), 10 ** rng.uniform(1.5, 5), float("inf")]) for _ in "12")
    gamma3 = rng.choice([0.0, 10 ** rng.uniform(-5, -1), 10 ** rng.uniform(-5, -1)])
    rod = {"F": rng.uniform(0, min(80, 0.8 * k1)), "k1": k1, "k2": k2, "gamma3": gamma3}
    return rod | ({"gamma1": 10 ** rng.uniform(-0.5, 0.5)} if rng.random() < 0.3 else {})


def drawn_arm(rng: Random) -> dict[str, Any]:
    """The quantities of an arm, in this unit or that, or in SI."""
    arm: dict[str, Any] = {
        "length": rng.choice(["10 cm", "120 mm", 0.08]),
        "young": rng.choice(["80 kPa", "0.1 MPa", 2e5]),
        "viscosity": rng.choice(["1.4 Pa s", "1 mPa s", 0.5]),
    }
    arm |= rng.choice(
        [{"radius": "5 mm"}, {"width": "6 mm", "height": "5 mm"}, {"width": 5e-3, "height": "8 mm"}]
    )
    arm |= rng.choice(
        [{"pressure": f"{rng.uniform(0, 4):.3g} kPa"}, {"force": f"{rng.uniform(0, 200):.3g} mN"}]
    )
    return arm | ({"poisson": rng.choice([0.3, 0.49])} if rng.random() < 0.3 else {})


def call(rng: Random) -> Call:
    """A call that is right, or one with a mistake in a key or a value."""
    task = rng.choice(TASKS)
    kind = rng.choice(["Rod", "Rod", "Arm"])
    rod = drawn_rod(rng) if kind == "Rod" else drawn_arm(rng)
    options = {key: rng.choice(values) for key, values in OPTIONS[task].items() if rng.random() < 0.5}
    options |= {"accuracy": ACCURACY[task]} if task in ACCURACY else {}
    if task == "branch":
        options.setdefault("stop", 30.0)
    mistake = rng.random()
    if mistake < 0.2:
        key = rng.choice([*rod, *options])
        wrong = misspelt(rng, key)
        place = rod if key in rod else options
        place[wrong] = place.pop(key)
        return Call(task, rod, options, (wrong, key), kind)
    if mistake < 0.4:
        key = rng.choice([*rod, *options])
        (rod if key in rod else options)[key] = rng.choice(WRONG_VALUES)
    if mistake > 0.9:
        options[rng.choice(["colour", "k3", "F", "taper", "length", "mods", "points", "task"])] = 3
    return Call(task, rod, options, kind=kind)


def misspelt(rng: Random, key: str) -> str:
    """A key with one letter left out, doubled, exchanged or of the other case; never a known one."""
    known = {name for task in CONFIG_CLASSES_BY_TASK for name in OPTIONS.get(task, {})} | {
        "F",
        "k1",
        "k2",
        "gamma3",
        "gamma1",
    }
    for _ in range(50):
        i = rng.randrange(len(key))
        wrong = rng.choice(
            [
                key[:i] + key[i + 1 :],
                key[: i + 1] + key[i:],
                key[:i] + key[i].swapcase() + key[i + 1 :],
                key[:i] + key[i + 1 : i + 2] + key[i] + key[i + 2 :],
            ]
        )
        if wrong.isidentifier() and wrong != key and wrong not in known:
            return wrong
    return key + "_"


def config(rng: Random) -> str:
    """A small sweep as the text of a config."""
    task = rng.choice([*TASKS, "phase_diagram"])
    rod = drawn_rod(rng) | {"F": rng.uniform(5, 28)}
    names = (
        [*CONFIG_CLASSES_BY_TASK[task].rod_parameters_used({})]
        if task != "phase_diagram"
        else ["F", "k1", "k2", "gamma3"]
    )
    values: dict[str, Any] = {name: f"{rod.get(name, 1):.6g}" for name in names}
    values["k2"] = f"[{100 + 400 * rng.random():.4g}, {1e3 + 4e3 * rng.random():.5g}]"
    if task == "phase_diagram":
        values |= {"F": "[5, 20, 29]", "k1": f"[{30 + 100 * rng.random():.4g}, 1.0e4]", "k2": "1.0e4"}
    options = {key: rng.choice(v) for key, v in OPTIONS.get(task, {}).items() if rng.random() < 0.3}
    written = {True: "true", False: "false"}
    # "longitudinal" and "nodes" are not taken without others
    options = {
        key: written[value] if isinstance(value, bool) else value
        for key, value in options.items()
        if key not in ("longitudinal", "nodes")
    }
    lines = [f"task: {task}", "parameters:", *(f"  {name}: {value}" for name, value in values.items())]
    lines += [f"{task}: {{{', '.join(f'{k}: {v}' for k, v in options.items())}}}"] if options else []
    lines += [f"accuracy: {ACCURACY[task]}"] if task in ACCURACY else []
    return "\n".join(lines).replace("inf", ".inf") + "\n"


def words(rng: Random, file: str, config: str) -> Words:
    """A command on a result file or a config, its options often wrong."""
    output = rng.choice(["o", "out put", "ö", "sub/o"]) + rng.choice(ENDINGS)
    table = rng.choice(
        [*TABLE_NAMES.values(), GRID_TABLE, BRANCHES_TABLE, POINTS_TABLE, "", "crossing", "Modes"]
    )
    column = rng.choice(
        ["F", "k1", "status", "growth_rate", "crossing_F", "F_hopf", "seconds", "k3", "", "class"]
    )
    columns = ",".join([column, rng.choice(["k2", "gamma3", "status", column, "branch_F", "u"])])
    whole = {
        "export": ["--table", table, "--columns", columns, "--units", "--replace", "-o", output],
        "plot": [
            "--what",
            rng.choice(["cycle", "maps", "energy", "x"]),
            "--point",
            rng.choice("0123"),
            "-o",
            output,
        ],
        "show": ["--statuses"],
        "snapshot": ["-o", output],
        "check": [
            "--set",
            rng.choice(["F=3", "accuracy=2", "parameters.taper=1", "title=a", "task=modes", "x"]),
        ],
        "run": ["-o", output, "--shard", rng.choice(["1/1", "2/1", "1"]), "-q", "--strict"],
        "merge": [],
    }
    name = rng.choice(list(whole))
    given = pairs(whole[name])
    asked = [word for pair in given if rng.random() < 0.5 for word in pair]
    target = config if name in ("check", "run") else file
    if rng.random() < 0.1:
        target = rng.choice([file, config, "nothing.h5", ".", "points.csv"])
    return Words([name, *([output] if name == "merge" else []), target, *asked])


def pairs(words: list[str]) -> list[list[str]]:
    """Options with their values."""
    found: list[list[str]] = []
    for word in words:
        if word.startswith("-") or not found:
            found.append([word])
        else:
            found[-1].append(word)
    return found
