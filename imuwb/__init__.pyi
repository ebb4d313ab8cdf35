from . import analysis as analysis
from . import axes as axes
from . import conditioning as conditioning
from . import errors as errors
from . import geodesy as geodesy
from . import health as health
from . import identification as identification
from . import log as log
from . import navigation as navigation
from . import notes as notes
from . import options as options
from . import progress as progress
from . import readers as readers
from . import replay as replay
from . import sampling as sampling
from . import simulation as simulation
from . import statistics as statistics
from . import stochastic as stochastic
from . import texts as texts
from . import units as units
from . import writers as writers
from .log import Log as Log
from .readers import describe as describe
from .readers import read as read
from .selection import select as select
from .stochastic import ImuErrorModel as ImuErrorModel

__version__: str
