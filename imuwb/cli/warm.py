"""imuwb warm: compiles everything before it is needed."""

import os
import time

from imuwb.errors import ImuwbError
from imuwb.texts import counted


def warm() -> None:
    """Compile everything once, so that no later run has to.

    This is for an image, or before many workers start. The code is kept in the folder that NUMBA_CACHE_DIR names, else beside the modules of imuwb, else in the cache of the user. Later
    runs read it there even if they cannot write there. It is valid for one version of imuwb, Python and numba, and for one type
    of processor. A file there that is damaged is made again.

    Example: imuwb warm
    """
    from imuwb import kept_code  # noqa: PLC0415 - help must not wait for numba
    from imuwb.analysis import Answer  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.signatures import compile_all  # noqa: PLC0415

    began = time.perf_counter()
    count, made, failed = compile_all()
    if kept_code.lost:
        raise ImuwbError(f"compiled code cannot be kept ({kept_code.lost[0]}); {kept_code.REMEDY}")
    took = time.perf_counter() - began
    changed = f"{counted(len(failed), 'function')} changed since the list was made; compiled when needed."
    answer = Answer(
        f"{count} functions are ready after {took:.1f} s; {'they were compiled' if made else 'all were there'}",
        sentences=(changed,) if failed else (),
    )
    place = f"{os.path.commonpath(kept_code.used)} ({counted(len(kept_code.used), 'folder')})"
    print_panel(answer, Origin("warm", (), wrote=(place,)), data=True)
