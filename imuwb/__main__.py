"""``python -m imuwb``."""

from imuwb.cli import main

main()
