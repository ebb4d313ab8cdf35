from .catalogue import schema as schema
from .catalogue import schema_names as schema_names
