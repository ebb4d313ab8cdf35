"""The papers that imuwb implements, reproduced: every table and figure beside ours.

Each paper is a command: quinchia, el-diasty and hassaballa. It simulates the paper's sensors, runs the analyses of imuwb, and states
for every printed value ours with its interval, and whether the two agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, get_type_hints

from imuwb_plugins.reproduce.parameters import ElDiasty, Hassaballa, Quinchia

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.analysis import Answer, Review
    from imuwb.log import Log

__all__ = ["METHODS"]


class Paper:
    """The analysis of one paper; its modules are imported on first use, so that help does not wait for numpy."""

    LOGS: ClassVar = (0, 0)

    def __init__(self, parameters: Any, module: str) -> None:  # noqa: ANN401 - a dataclass of options
        """Take the options, whose docstring is the help, and the name of the module with ``run``."""
        self.Parameters, self.__doc__ = parameters, parameters.__doc__
        self._module = f"{__name__}.{module}"

    def run(self, logs: Sequence[Log], parameters: Any) -> Any:  # noqa: ANN401 - each paper has its own options
        """Return the paper beside ours."""
        return import_module(self._module).run(logs, parameters)

    def returns(self) -> Any:  # noqa: ANN401 - a type
        """Return the type of the result."""
        return get_type_hints(import_module(self._module).run)["return"]

    def draw(self, result: Any, review: Review) -> None:  # noqa: ANN401 - as above
        """Show every table and figure."""
        import_module(f"{__name__}.shown").draw(result, review)

    def answer(self, result: Any) -> Answer:  # noqa: ANN401 - as above
        """Return how many values of each table agree."""
        return import_module(f"{__name__}.shown").answer(result)


#: name of the command -> the analysis
METHODS = {
    "quinchia": Paper(Quinchia, "quinchia.compute"),
    "el-diasty": Paper(ElDiasty, "el_diasty.compute"),
    "hassaballa": Paper(Hassaballa, "hassaballa.compute"),
}
