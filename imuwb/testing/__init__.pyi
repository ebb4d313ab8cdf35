from .checking import check as check
from .checking import kind_of as kind_of
from .checking import methods_of as methods_of
from .outcomes import Outcome as Outcome
from .outcomes import Report as Report
