"""The deterministic terms of an error model as matrices: measured = M true + G force + b, for gyros and accelerometers."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.log import AXES
from imuwb.stochastic import AxisModel, ImuErrorModel

SINGULAR = 1e-6  #: determinant; that of a sensor is near 1


@dataclass(frozen=True, slots=True, eq=False)
class Matrices:
    """The linear calibration of a sensor. SI."""

    gyro: Floats  #: (3, 3) M of the gyros
    gyro_bias: Floats  #: (3,) rad/s
    leak: Floats  #: (3, 3) G, rad/s per m/s²
    accel: Floats  #: (3, 3) M of the accelerometers
    accel_bias: Floats  #: (3,) m/s²

    @staticmethod
    def of(model: ImuErrorModel) -> "Matrices":
        """Return the matrices of a model; an axis that it does not have is perfect."""
        axes = [model.axes.get(axis, AxisModel()) for axis in AXES]
        gains = [np.array([_row(axes[first + i], i) for i in range(3)]) for first in (0, 3)]
        biases = [np.array([axes[first + i].bias for i in range(3)]) for first in (0, 3)]
        leak = np.array([axes[i].g_sensitivity for i in range(3)])
        return Matrices(gains[0], biases[0], leak, gains[1], biases[1])

    def check(self) -> None:
        """Check that a true value can be had from each measured one.

        Raises:
            ValueError: a matrix that cannot be inverted.
        """
        for sensor, matrix in (("gyros", self.gyro), ("accelerometers", self.accel)):
            if not abs(np.linalg.det(matrix)) > SINGULAR:
                raise ValueError(f"the matrix of the {sensor}, {matrix.tolist()}, cannot be inverted")

    def model(self, name: str, source: str) -> ImuErrorModel:
        """Return an error model of these matrices alone."""
        axes: dict[str, AxisModel] = {}
        for place, axis in enumerate(AXES):
            gain, bias = (self.gyro, self.gyro_bias) if place < 3 else (self.accel, self.accel_bias)  # noqa: PLR2004
            row = gain[place % 3]
            others = [float(row[k]) for k in range(3) if k != place % 3]
            found = AxisModel(
                bias=float(bias[place % 3]),
                scale_factor=float(row[place % 3]) - 1,
                cross_coupling=(others[0], others[1]),
            )
            if place < 3 and self.leak[place].any():  # noqa: PLR2004
                x, y, z = map(float, self.leak[place])
                found = replace(found, g_sensitivity=(x, y, z))
            axes[axis] = found
        return ImuErrorModel(name, axes, {"source": source})


def _row(axis: AxisModel, place: int) -> list[float]:
    row = list(axis.cross_coupling)
    row.insert(place, 1 + axis.scale_factor)
    return row


def lower_and_turn(matrix: Floats) -> tuple[Floats, Floats]:
    """Return a lower triangular matrix with a positive diagonal, and a rotation, whose product is the matrix.

    Raises:
        ValueError: a matrix that cannot be inverted, or that mirrors.
    """
    turned, upper = np.linalg.qr(matrix.T)
    signs = np.sign(np.diag(upper))
    if not signs.all() or np.linalg.det(matrix) <= 0:
        raise ValueError(f"the matrix {matrix.tolist()} mirrors the axes or cannot be inverted")
    return (upper.T * signs), (turned * signs).T
