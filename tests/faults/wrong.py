"""What docs/file-format.md allows for no key, or not for a certain key, as YAML."""

LONG_INTEGER = "9" * 90_000
NEVER = [
    "[[1]]", "[1, [2]]", "[null]", "{nonsense: 1}", "{start: 1}", "{1: 2}", "{[1]: 2}", "{{}: 2}", "[]", "{}",
    "2001-01-01", "2001-02-30", "2001-12-14t21:59:43.10-05:00", "12:30:45", "1:" * 400 + "1", "1e400",
    "-1e400", "1" + "0" * 400 + ".5", "1" + "0" * 400, "1" + "0" * 4000, LONG_INTEGER, "-" + LONG_INTEGER,
    "0x" + "f" * 900, "0x" + "f" * 9000, "0o" + "7" * 900, "0o" + "7" * 9000, "0b" + "1" * 9000, ".nan",
    "nan", "true", "[true]", "[.nan]", "[1, 1]", "[2, 1]", '["1"]', '"\\x07"', '"\\0"', '"\\ud800"',
    '"\\u202e"', "x" * 900, "x" * 10_000, '"' + "y" * 90_000 + '"', "[" * 5000, "{a: " * 5000,
    "[" * 15 + "]" * 15, "{a: " * 15 + "1" + "}" * 15, "!!python/object/apply:os.system [touch executed]",
    "!!python/name:os.system", "!!binary aGVsbG8=",
    "!!python/object/new:subprocess.Popen [[touch, executed]]", "!!str 3", "!!float 3", "!!set {a, b}",
    "!!omap [a: 1]", "!local 3", "!<tag:yaml.org,2002:int> 3", "! 3", "*a", "&a", "&a 3", "&a &b 1",
    "{<<: {a: 1}}", "{<<: 3}", "<<", "=", "@", "`", "%", "? a", "]", "}", ",", ": ", '"', "'", "'\\''",
    '"\\q"', '"\\x1"', "1 2: 3", "\u0000", "\u0007", "\ufffe", "\u2028", "\x85",
]  # fmt: skip
"""For no key at all; in some places they are no YAML, or break the line."""
NOTHING = {"}", ",", "\x85", "\u2028", "~"}
"""Of what follows and of NEVER, what YAML may take for no value at all, which MAY_BE_NOTHING allows."""
OPTIONAL_OF_ARM = ("density_difference", "tip_radius", "law", "section")
"""Keys of an arm in a config, of which it may have none."""
MAY_BE_NOTHING = {
    ("material",), ("phase_diagram", "bautin_along"),
    *(("parameters", name) for name in ("points", "gamma1", "taper", "columns", "arm")),
    *(("parameters", "arm", name) for name in OPTIONAL_OF_ARM),
}  # fmt: skip

NO_NUMBER = ["abc", '"3"', "''", "1e", "0x", "--1", "1,5", "+", ".", "yes"]
NO_RANGE = [
    "{start: 0, stop: 1}", "{start: 0, stop: 1, num: 0}", "{start: 0, stop: 1, num: -3}",
    "{start: 0, stop: 1, num: 2.0}", "{start: 0, stop: 1, num: true}", '{start: 0, stop: 1, num: "3"}',
    "{start: 0, stop: 1, num: null}", "{start: 0, stop: 1, num: .inf}", "{start: 0, stop: 1, num: 1.5e0}",
    "{start: 0, stop: 1, num: 1000000000000}", "{start: 0, stop: 1, num: 9223372036854775808}",
    "{start: 0, stop: 1, num: 1" + "0" * 900 + "}", "{start: 0, stop: 1, num: [3]}",
    "{start: 2, stop: 1, num: 3}", "{start: 1, stop: 1, num: 3}", "{start: 1, stop: 2, num: 1}",
    "{start: .inf, stop: 2, num: 3}", "{start: 1, stop: inf, num: 3}", "{start: -1e308, stop: 1e308, num: 3}",
    "{start: 0, stop: 1, num: 3, spacing: log}", "{start: 1, stop: 2, num: 3, spacing: cubic}",
    "{start: 1, stop: 2, num: 3, spacing: null}", "{start: 1, stop: 2, num: 3, spacing: [log]}",
    "{start: 1, stop: 2, num: 3, step: 1}", "{start: a, stop: 2, num: 3}", "{start: null, stop: 2, num: 3}",
    "{start: 1, start: 1, stop: 2, num: 3}", "{start: [1], stop: 2, num: 3}", "{start: {}, stop: 2, num: 3}",
    "{start: 1e400, stop: 2, num: 3}", "{start: 1, stop: 1.0000000000000002, num: 9}",
    "{start: 0, stop: 5e-324, num: 9}", "{Start: 1, stop: 2, num: 3}",
    "{? [1] : 1, start: 1, stop: 2, num: 3}",
]  # fmt: skip
STIFFNESS = [*NO_NUMBER, *NO_RANGE, "0", "-0.0", "-1", "-.inf", "[-1, 1]", "1e-320"]
WHOLE = [*NO_NUMBER, "~", "1.0", "1e1", "-1", "[3]", ".inf", "1000000000", "99999999999999999999"]
FLAG = ["yes", "no", "on", "1", "0", '"true"', "~", "[true]"]
SECTION = ["~", "3", "true", "abc", "[]", "[1]", "[{}]", "''", ".inf"]
FOR_KEY: dict[tuple[str, ...], list[str]] = {
    ("title",): ["3", "~", "[a]", "a" * 201],
    ("task",): ["spectra", "~", "3", "[spectrum]", "{spectrum: 1}", "Spectrum", "''", "|", ">"],
    ("accuracy",): [*NO_NUMBER, "~", "0", "-1e-8", "1e-14", "0.1", "1", ".inf", "[1e-8]", NO_RANGE[0]],
    ("parameters", "F"): [*NO_NUMBER, *NO_RANGE, ".inf", "-.inf", "[1, inf]", "1e308"],
    ("parameters", "k1"): STIFFNESS,
    ("parameters", "k2"): STIFFNESS,
    ("parameters", "gamma3"): [*NO_NUMBER, *NO_RANGE, "-1e-300", ".inf", "-.inf", "[-1, 1]"],
    ("parameters", "gamma1"): [*NO_NUMBER, *NO_RANGE, "0", "-1", "inf", "-.inf"],
    ("parameters", "points"): [
        "3",
        "[a]",
        "none.csv",
        "/",
        "/dev/null",
        "/dev/zero",
        '"a\\0b"',
        "a" * 300,
        "|",
    ],
    ("thresholds", "F_max"): [*NO_NUMBER, "~", "0", "-3", ".inf", "[3]"],
    ("limit_cycle", "amplitude"): [*NO_NUMBER, "~", "0", "-3", "1.1", ".inf", "[3]"],
    ("limit_cycle", "start"): ["next", "~", "3", "[mode]"],
    ("limit_cycle", "along"): ["f", "k3", "~", "3", "[F]"],
    ("limit_cycle", "direction"): ["left", "~", "3", "[up]"],
    ("limit_cycle", "time"): ["tau3", "~", "3", "[tau1]"],
}
"""For a key, beside NEVER; whole numbers, flags and sections are recognised by their type."""

KEYS = [
    "1", "1.5", "true", "null", "[1]", "{a: 1}", "2001-01-01", "''", '"\\n"', '"\\x07"', '"\\u202e"',
    '"\\ud800"', "F.num", "..", "__class__", "model_config", "x" * 900, "y" * 50_000, '"' + "a " * 400 + '"',
    "? [a, b]\n", "0x" + "f" * 900, "0x" + "f" * 5000, "!!str a", "&a a", "*a", "<<", "=", "é", "\U0001f600",
    "\\", "%a", "@a", "`a`", ".inf", ".nan", "- a",
]  # fmt: skip
"""What is no key anywhere."""

PLAUSIBLE = [
    "0", "1", "-1", "1e300", "-1e300", "5e-324", "inf", "2", "100", "1000000", "[1, 2]", "[inf]", "~",
    "previous", "tau1", "{start: 1, stop: 9, num: 5}",
    "{start: 1.0e-300, stop: 1.0e+300, num: 4, spacing: log}", "{start: -40, stop: 9000, num: 1000000}",
    NO_RANGE[3],
]  # fmt: skip
"""Values of the right kind, often extreme, which somewhere may be allowed."""

OVERRIDES = [
    "", "=", "==", "a", "=3", ".=3", "a.=3", ".a=3", "a..b=3", "accuracy", "accuracy=", "accuracy==",
    "accuracy=1=2", "title.x=3", "accuracy.x=3", "parameters=3", "parameters=", "parameters={}",
    "parameters=[]", "task=", "task={}", "parameters.gamma3.start.x.y=3", "parameters.gamma3.begin=3",
    "parameters.__class__=3", "__class__=3", "model_config=3", "parameters.F\n=3", "\n=3", "accuracy=1e-8\nb",
    "accuracy=1\n---\n2", "acc\x07uracy=3", "\u202eaccuracy=3", "accuracy =x", " =3", "a b=3", "1=3", "[a]=3",
    "*a=3", "&a=3", "!!str a=3", "#=3", "%=3", '"accuracy"=1e-8', ".".join("a" * 5000) + "=3",
    ".".join(["parameters", *"a" * 30]) + "=3", "k" * 90_000 + "=3", "k" * 90_000, "k=" + "v" * 90_000,
    "title=" + "v" * 90_000, "accuracy=" + "[" * 9000, "accuracy=*a", "accuracy=&a 3\n*a",
    "accuracy=!!python/object/apply:os.system [touch executed]", "accuracy=%YAML 1.1\n---\n3",
    "accuracy=1e400", "accuracy=" + LONG_INTEGER, "accuracy=0x" + "f" * 9000, "a={<<: {b: 1}}",
    "parameters=<<", "<<={accuracy: 1}", "parameters.<<={F: 1}", "accuracy=\udcff", "\udcff=3", "\udcff",
    ".".join(["x"] * 15) + "=" + "[" * 15 + "]" * 15,
]  # fmt: skip
"""What `--set` may not say; a lone surrogate is a byte that is no UTF-8."""
