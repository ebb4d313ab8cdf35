from .batch import Batch as Batch
from .batch import Reader as Reader
from .batch import Remark as Remark
from .read_options import ReadOptions as ReadOptions
from .reading import describe as describe
from .reading import read as read
from .reading import reader_of as reader_of
from .reading import stream as stream
