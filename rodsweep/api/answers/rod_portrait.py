"""`rod.portrait()`: all results for one rod, as a picture, a paragraph and an `Answer` for each result."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

from ...config.document.call_argument_errors import refusing_wrong_arguments
from ...post.figures.request import FigureClass
from ...post.rod_portrait.paragraph import paragraph
from ...post.rod_portrait.portrait_drawing import draw_rod_portrait
from ...post.rod_portrait.portrait_files import require_portrait_path, write_portrait
from ...post.rod_portrait.results import RodResults
from ...post.tables.alignment import wrap_cell_text
from ...results.file.view import ResultView
from ...solve.solve_lock import one_at_a_time
from ...tasks.rod_portrait import PortraitRequest, solve_rod_results
from ...tasks.running.job import Job
from ..dataset import require_file_path, view_of_dataset
from ..keyword_arguments import keyword_value_of_yaml_types
from ..solving_in_process import solve_in_process
from .answer import Answer

SAVE_PORTRAIT_EXAMPLE = 'rod.portrait().save("portrait.png")'


@dataclass(frozen=True)
class RodPortrait:
    """All results for one rod. Notebooks display the picture, `save` writes the picture into a file, and
    `paragraph` describes the rod.

    Every result behind the picture is an `Answer`: `thresholds`; `criticality` and `branch`, None if the task
    could not be solved; `modes` by kind of threshold; `cycles` by force. `missing` has the reason why a
    result could not be solved, by task.
    """

    rod: str
    results: RodResults = field(repr=False)
    answers_by_config: Mapping[str, Answer] = field(repr=False)
    """Answers by the YAML text of their configs."""

    @cached_property
    def paragraph(self) -> str:
        """Description of the rod: thresholds, criticality, branches, coexisting stable states, three
        cycles."""
        return paragraph(self.results)

    @property
    def thresholds(self) -> Answer:
        """Thresholds of the straight rod along F."""
        return self._task_answer(self.results.views["thresholds"])

    @property
    def criticality(self) -> Answer | None:
        """Criticality of the Hopf points; None if the task could not be solved."""
        return self._answer("criticality")

    @property
    def branch(self) -> Answer | None:
        """Branches of cycles from the Hopf points; None if the task could not be solved."""
        return self._answer("branch")

    @property
    def modes(self) -> dict[str, Answer]:
        """Leading modes at the first threshold of each kind, by kind: onset, hopf. A kind without a threshold
        has no entry."""
        return {
            kind: self._task_answer(view)
            for kind, (_, view) in self.results.modes_at_first_thresholds.items()
        }

    @property
    def cycles(self) -> dict[float, Answer]:
        """Limit cycles at three forces, by force; empty if no branch has a stable cycle. If no cycle was
        found at a force, the status of its answer gives the reason."""
        return {F: self._task_answer(view) for F, view in self.results.cycles}

    @property
    def missing(self) -> dict[str, str]:
        """Reason for every result that could not be solved, by task."""
        return dict(self.results.missing_result_reasons)

    def _task_answer(self, view: ResultView) -> Answer:
        return self.answers_by_config[view.attributes["config"]]

    def _answer(self, task: str) -> Answer | None:
        view = self.results.views.get(task)
        return None if view is None else self._task_answer(view)

    @one_at_a_time
    @refusing_wrong_arguments("rod.portrait().figure()")
    def figure(self) -> FigureClass:
        """The picture as a new `matplotlib.figure.Figure`, without the paragraph."""
        return draw_rod_portrait(self.results, with_words=False)

    @one_at_a_time
    @refusing_wrong_arguments(SAVE_PORTRAIT_EXAMPLE)
    def save(self, path: str | Path) -> str:
        """Writes the portrait (.png, .pdf, .svg, or .html with tables) and returns a sentence about the
        file."""
        output = require_file_path(path, SAVE_PORTRAIT_EXAMPLE)
        require_portrait_path(output)
        return write_portrait(self.results, output)

    def __repr__(self) -> str:
        texts = self.paragraph, f"{self.rod}, portrait"
        return "\n".join(wrap_cell_text(text, indent="") for text in texts)

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        image = BytesIO()
        self.figure().savefig(image, format="png", dpi=110)
        return {"image/png": image.getvalue(), "text/plain": repr(self)}


def solve_portrait(rod: str, request: PortraitRequest, progress: bool | None) -> RodPortrait:
    """Solves all results of a portrait in this process, and returns the portrait. rod: text of the rod.
    progress: whether to display progress; None: only in a terminal or a notebook. Raises InputError for an
    invalid request."""
    answers_by_config: dict[str, Answer] = {}
    plain_values = {
        name: keyword_value_of_yaml_types(name, getattr(request, name)) for name in ("F_max", "accuracy")
    }

    def solve(job: Job) -> ResultView:
        solved = solve_in_process(job, progress=progress)
        answers_by_config[job.given_config_yaml] = Answer(rod, solved, solved.messages[0])
        return view_of_dataset(solved.dataset, Path(job.title))

    results = solve_rod_results(replace(request, **plain_values), solve)
    return RodPortrait(rod, results, answers_by_config)
