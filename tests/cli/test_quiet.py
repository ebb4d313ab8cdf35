"""A command opens no socket and starts no program; tests/studies/system_calls.md has the traces of all commands."""

import sys

import pytest

ACTS = ("socket.connect", "socket.bind", "socket.getaddrinfo", "socket.sendto", "subprocess.Popen", "os.system", "os.exec", "os.fork",
        "os.posix_spawn", "os.spawn", "os.startfile", "webbrowser.open", "urllib.Request")  # fmt: skip
seen, listening = list[str](), list[bool]()


def hook(event, arguments):
    if listening and event in ACTS:
        seen.append(f"{event} {arguments}")


@pytest.mark.slow
def test_commands_open_no_socket_and_start_no_program(imuwb, static_mcap):
    sys.addaudithook(hook)  # it stays until the end of the process
    listening.append(True)
    try:
        for words in (
            ("info", static_mcap), ("convert", static_mcap, "-o", "o.csv"), ("plugins",),
            ("psd", static_mcap, "--json", "o.json", "--html", "o.html"), ("simulate", "static", "--preset", "mpu-6050", "--hours", "0.001", "-o", "s.csv"),
        ):  # fmt: skip
            assert imuwb(*words).code == 0, words
        assert not seen
        imuwb("psd", static_mcap, "--live", "--force")
        assert [one.split()[0] for one in seen if "9876" in one], "the hook sees what a user asks for"
    finally:
        listening.clear()
