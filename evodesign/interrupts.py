"""What Ctrl-C does to a command, from its first instruction to its last.

    while modules load          it ends at once, with exit code 130: nothing has begun
    while the command works     KeyboardInterrupt; a search may hold it off (`cli.session`)
    while a module of it loads  the same, once the module has loaded: libraries in C++ abort otherwise
    while it unwinds, or ends   it ends at once

The exit code is 3 when there is a run to be resumed, and 130 before. This module loads nothing but the
standard library, so that it comes first.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from pathlib import Path

STOPPED = 3
"""Exit code of what was stopped and can be resumed."""

INTERRUPTED = 130
"""Exit code of what was stopped and leaves nothing to resume."""

SOON = 0.02
"""Seconds after which an interrupt comes again that came while a module was loaded."""

SHOW_CURSOR = b"\x1b[?25h"


class Interrupts:
    """The interrupts of this process; its methods may be called while a signal is handled.

    Attributes:
        unwinding: whether a KeyboardInterrupt was raised.
        run: directory of the run that the command writes, once there is to be one.
    """

    def __init__(self) -> None:
        self.unwinding = False
        self.run: Path | None = None

    def begin(self) -> None:
        """Heed Ctrl-C from now on, unless it is ignored (by `nohup`, or a shell in the background)."""
        self._handle(lambda: self._leave(INTERRUPTED))
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)  # the last of what runs at the end

    def work(self) -> None:
        """What was needed is loaded; what the command makes from now on is to be tidied up after."""
        sys.unraisablehook = self._unraisable
        self._handle(self.interrupt)

    def interrupt(self) -> None:
        """Raise a KeyboardInterrupt; end at once if one was raised before.

        Raises:
            KeyboardInterrupt: the first time.
        """
        if self.unwinding:
            self._leave(self.code)
        if _loading(sys._getframe()):
            again = threading.Timer(SOON, os.kill, (os.getpid(), signal.SIGINT))
            again.daemon = True
            again.start()
            return
        self.unwinding = True
        raise KeyboardInterrupt

    def check(self) -> None:
        """Raise an interrupt again that was lost: some libraries clear every error while they load.

        Raises:
            KeyboardInterrupt: there was one.
        """
        if self.unwinding:
            raise KeyboardInterrupt

    def end(self, code: int) -> None:
        """All is done, and the exit code is known."""
        self._handle(lambda: os._exit(code))
        if callable(signal.getsignal(signal.SIGTERM)):
            signal.signal(signal.SIGTERM, signal.SIG_DFL)

    @property
    def code(self) -> int:
        """Exit code after an interrupt."""
        return STOPPED if self._resumable else INTERRUPTED

    @property
    def sentence(self) -> str:
        """What an interrupt did."""
        return f"stopped; go on with: evodesign resume {self.run}" if self._resumable else "stopped"

    @property
    def _resumable(self) -> bool:
        try:
            return self.run is not None and any(name.endswith(".mcap") for name in os.listdir(self.run))  # noqa: PTH208
        except OSError:
            return False

    def _handle(self, action: Callable[[], None]) -> None:
        def handler(signum: int, frame: FrameType | None) -> None:
            action()

        if callable(signal.getsignal(signal.SIGINT)):
            signal.signal(signal.SIGINT, handler)

    def _leave(self, code: int) -> NoReturn:
        """End without unwinding: what a run has logged is on the disk."""
        cursor = SHOW_CURSOR if os.isatty(2) else b""
        os.write(2, cursor + f"\n{self.sentence}\n".encode(errors="replace"))
        os._exit(code)

    def _unraisable(self, unraisable: Any) -> None:
        """A KeyboardInterrupt that was raised where nothing can be: it would be lost, with a traceback."""
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            self._leave(self.code)
        sys.__unraisablehook__(unraisable)


def _loading(frame: FrameType | None) -> bool:
    """Whether a module is loaded in a frame or in one that called it."""
    while frame is not None and not frame.f_code.co_filename.startswith("<frozen importlib."):
        frame = frame.f_back
    return frame is not None


INTERRUPTS = Interrupts()
"""Those of this process."""
