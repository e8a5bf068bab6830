"""Ctrl-C while kernels are compiled or loaded.

The compiler and LLVM are locked meanwhile.  An interruption in the middle of that leaves a lock
behind that nobody opens, or falls into a callback that drops it: the next thread that needs a
kernel would wait for ever.  So it waits until the kernel is there; where that takes long, or at a
second one, the program ends at once, as if it were killed, which nothing that it writes minds.
"""

import _thread
import signal
import threading
from types import FrameType
from typing import Any

from numba.core import event

__all__ = ["defer"]

# Seconds that a Ctrl-C waits: to load a kernel takes less, to compile one much more.
PATIENCE = 1.0


class _Deferred(event.Listener):  # type: ignore[misc]
    """Keeps Ctrl-C while this thread has the compiler; only the main one is ever interrupted."""

    def __init__(self) -> None:
        self._depth = 0
        self._came: threading.Timer | None = None
        self._usual: Any = None

    def on_start(self, event: object) -> None:
        """Listen instead of Python, unless somebody else does already."""
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth += 1
        if self._depth == 1 and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self._usual = signal.signal(signal.SIGINT, self._keep)

    def on_end(self, event: object) -> None:
        """Say what came meanwhile; all locks are open by then."""
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth -= 1
        if self._depth == 0 and self._usual is not None:
            signal.signal(signal.SIGINT, self._usual)
            self._usual = None
            if self._came is not None:
                self._came.cancel()
                self._came = None
                signal.raise_signal(signal.SIGINT)

    def _keep(self, number: int, frame: FrameType | None) -> None:
        if self._came is not None:
            signal.signal(number, signal.SIG_DFL)
            signal.raise_signal(number)
        self._came = threading.Timer(PATIENCE, _thread.interrupt_main)
        self._came.daemon = True
        self._came.start()


def defer() -> None:
    """Let Ctrl-C wait for kernels from now on."""
    event.register("numba:compiler_lock", _Deferred())
