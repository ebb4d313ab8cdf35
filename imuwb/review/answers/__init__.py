"""The answer of each command, as the panel of the terminal and as JSON."""
