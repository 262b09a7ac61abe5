"""Output of `rodsweep show`, and numbers of the demo used by several tests."""

HOPF, STABLE_AGAIN = 49.7580049161915, 155.600159298791
"""Of configs/fig2c.yaml, 40-digit roots of D."""

_computed: dict[str, bytes] = {}
"""The result file of each config that `shown` has run."""


def shown(command, config, *options):
    """What `show` says of the results of a config, computed once for all tests that ask for them."""
    command.write("c.yaml", config)
    path = command.directory / "c.h5"
    if "points:" in config or config not in _computed:
        assert command("run", "c.yaml").returncode == 0
        _computed[config] = path.read_bytes()
    path.write_bytes(_computed[config])
    return command("show", "c.h5", *options).stdout
