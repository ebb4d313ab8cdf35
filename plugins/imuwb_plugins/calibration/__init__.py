"""Calibration: bias, scale factors, cross-couplings and g-sensitivity from still positions or a rate table.

Each method is a command: six-position (the faces of a cube), multi-position (any attitudes) and rate-table (gyros).
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, get_type_hints

from imuwb_plugins.calibration.parameters import MultiPosition, RateTable, SixPosition

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.analysis import Answer, Review
    from imuwb.log import Log
    from imuwb.stochastic import ImuErrorModel

__all__ = ["METHODS"]


class Method:
    """The analysis of one method; its modules are imported on first use, so that help does not wait for numpy."""

    LOGS: ClassVar = (1, None)
    LEAVES_MODEL: ClassVar = "calibration"
    TAKES_COUNTS: ClassVar = True

    def __init__(self, parameters: Any, computing: str, drawing: str) -> None:  # noqa: ANN401 - a dataclass of options
        """Take the options, whose docstring is the help, and the names of the modules with ``run`` and ``draw``."""
        self.Parameters, self.__doc__ = parameters, parameters.__doc__
        self._computing, self._drawing = f"{__name__}.{computing}", f"{__name__}.{drawing}"

    def run(self, logs: Sequence[Log], parameters: Any) -> Any:  # noqa: ANN401 - each method has its own types
        """Return the calibration."""
        return import_module(self._computing).run(logs, parameters)

    def returns(self) -> Any:  # noqa: ANN401 - a type
        """Return the type of the result."""
        return get_type_hints(import_module(self._computing).run)["return"]

    def draw(self, result: Any, review: Review) -> None:  # noqa: ANN401 - each method has its own types
        """Show parameters, residuals, and samples before and after the correction."""
        import_module(self._drawing).draw(result, review)

    def answer(self, result: Any) -> Answer:  # noqa: ANN401 - each method has its own types
        """Return the parameters of each axis, and whether noise alone explains the residuals."""
        return import_module(f"{__name__}.answer").answer(result)

    def error_model(self, result: Any) -> ImuErrorModel:  # noqa: ANN401 - each method has its own types
        """Return the error model with the calibrated terms."""
        return result.model


#: name of the command -> the analysis
METHODS = {
    "six-position": Method(SixPosition, "positions", "position_view"),
    "multi-position": Method(MultiPosition, "positions", "position_view"),
    "rate-table": Method(RateTable, "rate_table", "rate_table_view"),
}
