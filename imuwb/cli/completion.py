"""The words that a shell asks to complete.

A shell asks by running the program without arguments. The environment then contains the line to complete: bash passes
COMP_WORDS and COMP_CWORD, zsh, fish and PowerShell pass _TYPER_COMPLETE_ARGS (``typer._completion_classes``).
"""

from collections.abc import Mapping

ASKED = "_IMUWB_COMPLETE"  #: name of the variable that is in the environment when a shell asks


def words_before(environment: Mapping[str, str]) -> list[str]:
    """Return the words between the program's name and the word that is to be completed."""
    if "COMP_CWORD" in environment:
        return environment.get("COMP_WORDS", "").split()[1 : int(environment["COMP_CWORD"])]
    line = environment.get("_TYPER_COMPLETE_ARGS", "")
    words = line.split()[1:]
    return words if line.endswith(" ") else words[:-1]
