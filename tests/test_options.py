import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import pytest

from imuwb.options import NOT_NEGATIVE, POSITIVE, Between, Form, Level, check, options_of, text_of


@dataclass(frozen=True)
class Ratio:
    FORMS = "A/B"
    first: str
    second: str

    @classmethod
    def from_text(cls, text: str) -> "Ratio":
        first, second = text.split("/")
        return cls(first, second)

    def __str__(self) -> str:
        return f"{self.first}/{self.second}"


@dataclass(frozen=True)
class Parameters:
    level: Level = 0.95
    own: Annotated[Level, "of the lines"] = 0.99
    mounting: Literal["auto"] | tuple[float, float, float] = (0.0, 0.0, 0.0)
    at: Annotated[Literal["own"] | tuple[tuple[float, float], ...], Form("START:DURATION,...", "200:30,430:60")] = ()
    wavelet: Annotated[tuple[int, ...], Between(1, 12)] = ()
    names: tuple[str, ...] = ("full",)
    degrade: dict[str, float] | None = None
    file: Path | None = None
    choose: bool = True
    delay: Annotated[Literal["auto"] | float, NOT_NEGATIVE] = 0.0
    ratio: Ratio | None = None
    orders: tuple[int, ...] = ()
    width: Annotated[float, POSITIVE] = 1.0

    def __post_init__(self) -> None:
        check(self)


@pytest.mark.parametrize(
    ("option", "text", "value"),
    [
        ("ratio", "2/3", Ratio("2", "3")),
        ("mounting", "auto", "auto"),
        ("mounting", "1, 2,-3.5", (1.0, 2.0, -3.5)),
        ("at", "own", "own"),
        ("at", "200:30, 430:60", ((200.0, 30.0), (430.0, 60.0))),
        ("at", "", ()),
        ("wavelet", "3..6", (3, 4, 5, 6)),
        ("wavelet", "4,6", (4, 6)),
        ("names", "none, full", ("none", "full")),
        ("degrade", "noise=3,jump=20", {"noise": 3.0, "jump": 20.0}),
        ("file", "a/b.toml", Path("a/b.toml")),
        ("choose", "no", False),
        ("delay", "auto", "auto"),
        ("delay", "0.25", 0.25),
        ("level", "0.9", 0.9),
        ("level", "0.6", 0.6),
        ("orders", "1..10000", tuple(range(1, 10_001))),
        ("delay", "0", 0.0),
    ],
)
def test_a_text_becomes_the_value_of_its_type(option, text, value):
    assert getattr(Parameters(**{option: text}), option) == value
    if text:
        again = Parameters(**{option: text_of(value)})
        assert getattr(again, option) == value


@pytest.mark.parametrize(
    ("option", "value", "rule"),
    [
        ("level", 0.5, "0.6 or more and below 1"),
        ("level", 1.0, "below 1"),
        ("level", math.nan, "0.6 or more"),
        ("own", 0.3, "0.6 or more"),
        ("mounting", "1,2", "auto or three numbers"),
        ("mounting", "1,2,nan", "three numbers"),
        ("mounting", (1.0, 2.0, math.inf), None),
        ("at", "200", "such as 200:30,430:60"),
        ("at", "200:30:1", "200:30"),
        ("wavelet", "0,3", "1 or more and 12 or less"),
        ("wavelet", "8..3", "3..8"),
        ("wavelet", "1..100000", "3..8"),
        ("degrade", "noise", "key=value"),
        ("degrade", "noise=1,noise=2", "key=value"),
        ("choose", "perhaps", "true or false"),
        ("delay", -1.0, "0 or more"),
        ("delay", "later", "auto or a number"),
        ("ratio", "2", "A/B"),
        ("orders", "0..10000", "3..8"),
        ("width", 0.0, "above 0"),
        ("width", math.inf, "above 0"),
    ],
)
def test_a_value_that_is_not_allowed_is_refused_with_option_value_and_rule(option, value, rule):
    if rule is None:  # without a range, any number is taken
        assert getattr(Parameters(**{option: value}), option) == value
        return
    with pytest.raises(ValueError, match=option) as error:
        Parameters(**{option: value})
    assert rule in str(error.value)


def test_an_annotation_declares_all_of_an_option():
    options = {option.name: option for option in options_of(Parameters)}
    assert options["level"].help == "level of all intervals and limits"
    assert options["own"].help == "of the lines"
    assert options["own"].between == options["level"].between
    assert options["at"].form == Form("START:DURATION,...", "200:30,430:60")


@pytest.mark.parametrize("end", [Between(0.0, 1.0), Between(0.0, 1.0, open_least=True, open_most=True)])
def test_an_open_end_does_not_belong_to_the_range(end):
    assert (0.0 in end, 1.0 in end) == (not end.open_least, not end.open_most)
    assert 0.5 in end
    assert -0.1 not in end
    assert 1.1 not in end
