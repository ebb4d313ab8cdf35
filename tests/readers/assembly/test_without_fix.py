"""Rows in which a receiver states that it has no fix are no fixes, whatever the receiver."""

import numpy as np
import pytest

from imuwb.health import check
from imuwb.readers import read
from imuwb.readers.assembly.without_fix import fix_types
from tests.readers.repairs import repairs


def table(tmp_path, name, kinds):
    rows = "".join(f"{i * 0.1:.1f},45.{i:04d},9.{i:04d},400,{kind}\n" for i, kind in enumerate(kinds))
    path = tmp_path / "gnss.csv"
    path.write_text(f"time_s,lat_deg,lon_deg,height_m,{name}\n{rows}")
    return read(path)


@pytest.mark.parametrize(
    ("name", "kinds", "kept"),
    [
        ("fix_type", [0] * 5 + [1] * 5 + [3] * 40, [3] * 40),
        ("fix_type", [3] * 20 + [1] * 10 + [6] * 20, [3] * 20 + [6] * 20),
        ("fix", [0] * 10 + [1] * 40, None),  # whether there is a fix
        ("fix", [1] * 50, None),
        ("fix_type", [""] * 10 + [3] * 40, [0] * 10 + [3] * 40),  # not known
    ],
)
def test_rows_without_a_fix_are_left_out_of_a_table(tmp_path, name, kinds, kept):
    (gnss,) = table(tmp_path, name, kinds).gnss
    lost = 0 if "" in kinds or set(kinds) == {1} else 10
    assert len(gnss) == 50 - lost
    assert (None if gnss.fix_type is None else gnss.fix_type.tolist()) == kept
    assert repairs(gnss) == ({"no_fix": lost} if lost else {})
    assert np.isfinite(gnss.position).all()


def test_a_receiver_that_waits_for_its_first_fix_is_no_fault(tmp_path):
    health = check(table(tmp_path, "fix_type", [0] * 10 + [3] * 40))
    assert [(fault.kind, fault.severity, fault.count) for fault in health.faults if "no fix" in fault.kind] == [
        ("no fix", "note", 10)
    ]


def test_a_type_that_no_receiver_has_is_not_known():
    assert fix_types(np.array([3.0, np.nan, np.inf, 1e300, -1e19, 6.0])).tolist() == [3, 0, 0, 0, 0, 6]
