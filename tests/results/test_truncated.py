"""Result files cut off at random offsets: `show`, `plot` and `run` refuse in a sentence, change nothing."""

from random import Random

import pytest
from surveyed import few

from rodsweep.errors import InputError
from rodsweep.post.figures import draw
from rodsweep.post.summary import show_summary
from rodsweep.results.file.result_file_writer import ResultFileWriter
from rodsweep.results.file.view import read_view
from rodsweep.sweep.points.ranges import Shard
from rodsweep.tasks.running.job import job_of_file, result_file_plan

CONFIGS = {
    "spectrum": """
task: spectrum
parameters: {F: [10, 30], k1: 1.0e4, k2: [50, 1.0e4], gamma3: 1.0e-4}
""",
    "thresholds": """
task: thresholds
parameters: {k1: [100, 1.0e4], k2: 1.0e4, gamma3: 1.0e-4}
""",
    "criticality": """
task: criticality
parameters: {k1: [200, 1.0e4], k2: 1.0e4, gamma3: 1.0e-4}
""",
    "branch": """
task: branch
parameters: {k1: 150, k2: 1.0e4, gamma3: 1.0e-4}
accuracy: 1.0e-4
""",
    "modes": """
task: modes
parameters: {F: [10, 30], k1: 1.0e4, k2: 1.0e4, gamma3: 1.0e-4}
modes: {nodes: 9, growth: false}
""",
}
CUTS = 40


@pytest.mark.parametrize("name", few([*CONFIGS], 2))
def test_file_cut_off_anywhere_is_refused_and_left_as_it_is(command, name, monkeypatch):
    config = command.write("c.yaml", CONFIGS[name])
    assert command("run", "c.yaml").returncode == 0
    path = command.directory / "c.h5"
    whole = path.read_bytes()
    monkeypatch.chdir(command.directory)
    job = job_of_file(config, ())
    plan = result_file_plan(job, job.task.solver(), Shard(), "")
    rng, refused = Random(name), 0
    for size in [0, 1, 8, 100, len(whole) - 1, *(rng.randrange(len(whole)) for _ in range(CUTS))]:
        path.write_bytes(whole[:size])
        attempts = (
            lambda: show_summary(read_view(path)),
            lambda: draw([read_view(path)], command.directory / "c.png", "smallest", None, ()),
            lambda: ResultFileWriter(path, plan).close(),
        )
        for attempt in attempts:
            with pytest.raises(InputError) as told:
                attempt()
            assert "\n" not in str(told.value)
            assert len(str(told.value)) < 400
            refused += 1
        assert path.read_bytes() == whole[:size]
        assert not (command.directory / "c.h5.journal").exists()
    assert refused == 3 * (CUTS + 5)


@pytest.mark.parametrize("words", [("show", "c.h5"), ("plot", "c.h5"), ("run", "c.yaml")])
def test_command_refuses_a_cut_file_in_one_line(command, words):
    command.write("c.yaml", CONFIGS["spectrum"])
    assert command("run", "c.yaml").returncode == 0
    path = command.directory / "c.h5"
    path.write_bytes(path.read_bytes()[:-100])
    done = command(*words)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "c.h5" in done.stderr
