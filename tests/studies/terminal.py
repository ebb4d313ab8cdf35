"""How long the answers of all commands are on terminals of 80 and 120 columns, and when their first line is there.

Each command runs in a terminal of its own (a pseudo-terminal of this machine) on the sample logs. Counted are the lines that stay on the
screen, and the CPU time of the command until its first letters. ``--full`` prints what commands printed before they had a panel.

    python tests/studies/terminal.py        # writes terminal.md beside it; POSIX only
"""

import fcntl
import os
import pty
import re
import struct
import sys
import tempfile
import termios
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STATIC, DRIVE = (str(ROOT / "samples" / name) for name in ("static.mcap", "drive.mcap"))
MODEL = "static.error-model.toml"
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("info", DRIVE),
    "health": ("health", DRIVE, "-o", "health.rrd"),
    "noise": ("noise", STATIC, "-o", "static.rrd"),
    "allan": ("allan", STATIC, "-o", "allan.rrd"),
    "psd": ("psd", STATIC, "-o", "psd.rrd"),
    "autocorrelation": ("autocorrelation", STATIC, "-o", "acf.rrd"),
    "autoregressive": ("autoregressive", STATIC, "-o", "ar.rrd"),
    "lssa": ("lssa", STATIC, "--highest", "1", "-o", "lssa.rrd"),
    "outage": ("outage", DRIVE, "--error-model", MODEL, "--models", "15AV,full", "-o", "drive.rrd"),
    "convert": ("convert", DRIVE, "-o", "drive-copy.mcap"),
    "simulate static": ("simulate", "static", "--preset", "mpu-6050", "--hours", "0.1", "-o", "made.mcap"),
    "simulate drive": ("simulate", "drive", "--duration", "120", "--sensor", "mpu-6050", "-o", "made-drive.mcap"),
    "simulate chamber": ("simulate", "chamber", "--preset", "mpu-6050", "--hours", "0.01", "-o", "chamber"),
    "model show": ("model", "show", MODEL),
    "model export": ("model", "export", MODEL, "--to", "kalibr", "-o", "kalibr.yaml"),
    "model compare": ("model", "compare", MODEL, "other.toml"),
    "model check": ("model", "check", MODEL, "--against", "other.toml"),
    "temperature": ("temperature", "warm.mcap", "-o", "warm.rrd"),
    "calibration": ("calibration", "multi-position", "hand/hand_held.mcap", "-o", "hand.rrd"),
    "plan": ("plan", "--preset", "mpu-6050"),
    "explain": ("explain", "bias instability"),
    "report": ("report", "static.rrd", "drive.rrd"),
    "catalog": ("catalog", "."),
}
NO_FORCE = (
    "info",
    "model show",
    "model compare",
    "model check",
    "plan",
    "explain",
)  #: commands that write no file here
FULL = ("info", "health", "noise", "allan", "psd", "autocorrelation", "autoregressive", "lssa", "outage", "convert",
        "model show", "model compare", "model check", "temperature", "calibration", "plan")  # fmt: skip
ESCAPES = re.compile(rb"\x1b\[[0-9;?]*[a-zA-Z]")


def ran(words: tuple[str, ...], columns: int, folder: str) -> tuple[int, int, float, float]:
    """Return the lines of a command, its longest line, and its CPU time until the first letters and in all, in s."""
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.execv(sys.executable, [sys.executable, "-m", "imuwb", *words])  # noqa: S606 - our own command line
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 60, columns, 0, 0))
    shown, first = b"", None
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:  # the command has ended
            break
        if not part:
            break
        shown += part
        if first is None and ESCAPES.sub(b"", shown).strip():
            first = _cpu(process)
    _, _, used = os.wait4(process, 0)
    text = [line.rsplit("\r", 1)[-1] for line in ESCAPES.sub(b"", shown).decode().replace("\r\n", "\n").split("\n")]
    lines = [line for line in text if line.strip() and "━" not in line]  # no bars of progress
    return len(lines), max(map(len, lines), default=0), first or 0.0, used.ru_utime + used.ru_stime


def _cpu(process: int) -> float:
    """Return the CPU time that a running process has used (s)."""
    fields = Path(f"/proc/{process}/stat").read_text("utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Run all commands, and write the table."""
    rows: list[str] = []
    sensor = ("--preset", "mpu-6050")
    with tempfile.TemporaryDirectory() as folder:
        ran(("simulate", "static", *sensor, "--hours", "0.1", "-o", "still.mcap"), 80, folder)
        ran(("simulate", "static", *sensor, "--hours", "0.1", "--temperature", "-10:40", "-o", "warm.mcap"), 80, folder)
        ran(("simulate", "hand-held", *sensor, "-o", "hand"), 80, folder)
        ran(("allan", "still.mcap", "--save-model", "other.toml"), 80, folder)
        for name, words in COMMANDS.items():
            force = () if name in NO_FORCE else ("--force",)
            narrow = ran((*words, *force), 80, folder)
            wide = ran((*words, *force), 120, folder)
            full = ran((*words, *force, "--full"), 120, folder)[0] if name in FULL else None
            rows.append(
                f"| `{name}` | {narrow[0]} | {wide[0]} | {'' if full is None else full} | {narrow[2]:.2f} | {narrow[3]:.1f} |"
            )
            print(rows[-1], flush=True)
    text = (
        "# Lines and first lines of all commands\n\n"
        "`python tests/studies/terminal.py`, on the sample logs (one hour at 20 Hz; a drive of ten minutes at 50 Hz), with compiled\n"
        "kernels in the cache. Lines that stay on the screen of a terminal, without\nthe rules of tables; with `--full` all tables and notes, which is what a\n"
        "command printed before it had a panel. CPU time until the first letters are on the terminal, and in all.\n\n"
        "| command | lines at 80 columns | at 120 | at 120 with `--full` | CPU to the first line [s] | CPU in all [s] |\n"
        "|---|---|---|---|---|---|\n" + "\n".join(rows) + "\n"
    )
    Path(__file__).with_suffix(".md").write_text(text, "utf-8")


if __name__ == "__main__":
    main()
