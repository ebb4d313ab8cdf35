"""JSON Schemas of the documents that imuwb writes, made from the types and tables that write them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
