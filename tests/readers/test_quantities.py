import pytest

from imuwb.errors import UsageError
from imuwb.readers.quantities import units_by_quantity


def test_units_of_a_position_go_to_both_angles():
    assert units_by_quantity({"position": "deg"}) == {"latitude": "deg", "longitude": "deg"}
    parts = {f"velocity_{way}" for way in ("north", "east", "down", "up")}
    assert set(units_by_quantity({"velocity": "cm/s"})) == parts


def test_an_unknown_quantity_lists_the_known():
    with pytest.raises(UsageError, match=r"quantity 'magnet'.*gyro, accel"):
        units_by_quantity({"magnet": "T"})


@pytest.mark.parametrize(
    ("quantity", "text"), [("gyro", "g"), ("accel", "deg/s"), ("time", "m"), ("position", "m"), ("velocity", "deg")]
)
def test_a_unit_of_another_dimension_is_refused(quantity, text):
    with pytest.raises(UsageError, match=rf"'{text}'.*{quantity}"):
        units_by_quantity({quantity: text})
