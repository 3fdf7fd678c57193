"""Fields of results by type; python/generate.py writes the modules."""

from .deviations import *
from .designs import *
from .machines import *
from .measurements import *
from .sets import *
