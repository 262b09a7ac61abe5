"""Point lists made bad: what lies in a CSV file, and whether it must be refused."""

from random import Random

HEADER = "F,k1,k2,gamma3\n"
GOOD = HEADER + "0,100,50,0\n10,inf,1e4,1e-4\n20,1e4,100,1e-2\n30,1e4,inf,0\n"
CELLS = [
    "nan", "inf", "-inf", "1e400", "-1e400", "0x1", "\u0661", "9" * 5000, "1_0", "1d3", "", "x", "'1'", "1 2",
    "\0", "1;2", "=1+1", "NaN", "infinity", "1e", "--1", "\u22121", "1" * 9999,
]  # fmt: skip
"""No force may be one of these."""


def bad_lists(rng: Random) -> dict[str, tuple[bytes, bool]]:
    """(content, whether it must be refused) by name."""
    texts = {
        "empty": "", "a line end": "\n", "no header": GOOD.removeprefix(HEADER), "only a header": HEADER,
        "semicolons": GOOD.replace(",", ";"), "tabs": GOOD.replace(",", "\t"), "a column twice": "F," + GOOD,
        "a column missing": "F,k1,k2\n1,2,3\n", "another column": GOOD.replace("gamma3", "gamma4"),
        "a header in quotes that never end": '"' + GOOD,
        "a quote that never ends": HEADER + '"0,1,1,1\n' * 30_000, "too few cells": GOOD + "1,2,3\n",
        "too many cells": GOOD + "1,2,3,4,5\n", "a comment": "# points\n" + GOOD,
        "a crushed rod": HEADER + "1,1,1,1\n", "k1 = 0": HEADER + "0,0,1,1\n",
        "k2 < 0": HEADER + "0,1,-1,1\n", "1/k1 overflows": HEADER + "0,5e-324,1,1\n",
        "gamma3 < 0": HEADER + "0,1,1,-1\n", "gamma3 = inf": HEADER + "0,1,1,inf\n",
        "thousands of columns": "F," * 50_000, "a long line": HEADER + "1," * 100_000,
        "no line end": "x" * 10**6, "a thousand lines and a bad one": GOOD + "1,2,3,4\n" * 1000 + "x\n",
        "NULs": "\0" * 10_000,
    }  # fmt: skip
    lists = {name: (text.encode(), True) for name, text in texts.items()}
    lists |= {f"F = {cell[:9]!a}": (f"{HEADER}{cell},1e4,1,1\n".encode(), True) for cell in CELLS}
    good = GOOD.encode()
    lists |= {
        "UTF-16": (GOOD.encode("utf-16"), True),
        "invalid UTF-8": (good + b"0,1,1,\xff\n", True),
        "HDF5": (b"\x89HDF\r\n\x1a\n" + rng.randbytes(3000), True),
        "random bytes": (rng.randbytes(3000), True),
        "a byte-order mark": (b"\xef\xbb\xbf" + good, False),
        "CR LF": (good.replace(b"\n", b"\r\n"), False),
        "quotes": (HEADER.encode() + b'"0","1","1","1"\n', False),
        "extreme": (HEADER.encode() + b"-1e308,1e-300,1e308,1e308\n", False),
    }
    for i in range(20):
        data = bytearray(good)
        for _ in range(rng.randint(1, 4)):
            data[rng.randrange(len(data))] = rng.choice(b',;"\n\r\0 x-.eE+9\xff')
        lists[f"random {i}"] = (bytes(data), False)
    return lists
