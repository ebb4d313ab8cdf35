"""Separators of thousands: numbers in groups are read as they are, or refused, and never taken for decimals."""

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.readers import read

ROWS = 400
RNG = np.random.default_rng(5)
RATES = np.round(RNG.normal(0, 0.1, (ROWS, 3)), 4)  # deg/s
FORCES = np.round(RNG.normal((0, 0, 1013.2), 9, (ROWS, 3)), 1)  # mg
HEADER = ("time_ms", "gx_deg_s", "gy_deg_s", "gz_deg_s", "ax_mg", "ay_mg", "az_mg")


def number(value, decimals, thousands, decimal):
    """Return a number with its digits in groups."""
    text = f"{value:,.{decimals}f}"
    return text.translate(str.maketrans({",": thousands, ".": decimal}))


def table(delimiter, thousands, decimal, quote=""):
    def cell(*number_of):
        text = number(*number_of, thousands, decimal)
        return f"{quote}{text}{quote}"

    rows = ([cell(10 * i, 0), *(cell(x, 4) for x in RATES[i]), *(cell(x, 1) for x in FORCES[i])] for i in range(ROWS))
    return "\n".join(delimiter.join(row) for row in (HEADER, *rows)) + "\n"


@pytest.mark.parametrize(
    ("delimiter", "thousands", "decimal", "quote"),
    [
        (",", ",", ".", '"'), (";", ",", ".", ""), ("\t", ",", ".", '"'), (",", "'", ".", ""), (";", "'", ",", ""), (";", ".", ",", ""),
        ("\t", ".", ",", '"'), (";", "", ",", ""), (",", "", ",", '"'),
    ],
)  # fmt: skip
def test_numbers_in_groups(tmp_path, delimiter, thousands, decimal, quote):
    path = tmp_path / "log.csv"
    path.write_text(table(delimiter, thousands, decimal, quote))
    (imu,) = read(path).imus
    assert imu.specific_force.time.tolist() == [10_000_000 * i for i in range(ROWS)]
    np.testing.assert_allclose(np.degrees(imu.angular_rate.value), RATES, atol=1e-12)
    np.testing.assert_allclose(imu.specific_force.value / 9.80665e-3, FORCES, atol=1e-9)


def test_commas_that_may_be_either_are_refused(tmp_path):
    path = tmp_path / "log.csv"
    rows = "".join(f"{i};1,00{i};1,10{i};2,00{i};1,2{i}3;4,56{i};16,38{i}\n" for i in range(10))
    path.write_text("time_ms;gx_deg_s;gy_deg_s;gz_deg_s;ax_m_s2;ay_m_s2;az_m_s2\n" + rows)
    with pytest.raises(UsageError, match=r"'1,000' may be thousands"):
        read(path)
