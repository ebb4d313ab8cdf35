from .compute import run as run
from .parameters import Parameters as Parameters
from .result import Axis as Axis
from .result import Band as Band
from .result import Result as Result
from .show import answer as answer
from .show import draw as draw
