from tests.cli.conftest import imuwb

__all__ = ["imuwb"]
