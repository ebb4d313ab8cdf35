"""The error model of an IMU."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from imuwb.documents import document_of
from imuwb.log import AXES
from imuwb.stochastic.axis_model import AxisModel
from imuwb.stochastic.description import axis_text
from imuwb.stochastic.error_model_document import model_of, parsed, written


@dataclass(frozen=True, slots=True)
class ImuErrorModel:
    """The axes ``gyro_x`` ... ``accel_z``, and where their figures come from.

    Raises:
        ValueError: an axis of another name.
    """

    name: str
    axes: Mapping[str, AxisModel]
    provenance: Mapping[str, str] = field(default_factory=dict[str, str])
    doubts: tuple[str, ...] = ()  #: what puts the figures in doubt, such as a record that is not still

    def __post_init__(self) -> None:
        """Check the names of the axes."""
        for axis in self.axes:
            if axis not in AXES:
                raise ValueError(
                    f"error model {self.name!r} has an axis {axis!r}; an axis must be one of {', '.join(AXES)}"
                )

    def to_toml(self) -> str:
        """Return the model as text."""
        return written(self.name, self.axes, self.provenance, self.doubts)

    @staticmethod
    def from_toml(text: str, where: str = "error model") -> ImuErrorModel:
        """Return the model that a text describes.

        Raises:
            UsageError: not TOML, an unknown key, unit or process; the message states which and where.
        """
        return ImuErrorModel(*parsed(text, where))

    @staticmethod
    def read(path: str | Path) -> ImuErrorModel:
        """Return the model in a file.

        Raises:
            UsageError: the file cannot be read, or is no error model.
        """
        return ImuErrorModel.of_document(document_of(path, "an error model"), str(path))

    @staticmethod
    def of_document(document: dict[str, object], where: str) -> ImuErrorModel:
        """Return the model that a TOML document is, with the errors of ``from_toml``; the document's keys are taken out."""
        return ImuErrorModel(*model_of(document, where))

    def __str__(self) -> str:
        """Return the name, a line for each axis in display units, and the doubts."""
        axes = (f"{a}: {axis_text(a, self.axes[a])}" for a in AXES if a in self.axes)
        return "\n".join([self.name, *axes, *(f"in doubt: {doubt}" for doubt in self.doubts)])
