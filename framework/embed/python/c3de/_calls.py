# SPDX-License-Identifier: Apache-2.0
"""Long calls: Ctrl-C, progress."""

import sys
import threading
from typing import Any, Callable, Optional, Union

from ._library import Error

POLL_S = 0.05  # between two checks for Ctrl-C


class _InterruptibleCall:
    """Runs a long call on a worker thread so that the main thread can handle Ctrl-C."""

    def __init__(self, call: Callable[[], None], cancel: Callable[[], None]):
        self._call, self._cancel = call, cancel
        self._error: Optional[BaseException] = None
        self._done = threading.Event()
        self._begin = threading.Lock()
        self._begun = self._withdrawn = False

    def _withdraw(self) -> bool:
        """Whether the call has not begun, and never will."""
        with self._begin:
            self._withdrawn = not self._begun
            return self._withdrawn

    def _run(self) -> None:
        with self._begin:
            if self._withdrawn:
                return
            self._begun = True
        try:
            self._call()
        except BaseException as error:  # passed on by wait()
            self._error = error
        finally:
            self._done.set()

    def wait(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            self._call()  # signals are for the main thread
            return
        thread = threading.Thread(target=self._run, name="c3de", daemon=True)
        interrupt: Optional[BaseException] = None
        is_started = False
        while True:
            try:
                if interrupt is not None:
                    if self._withdraw():
                        raise interrupt
                    self._cancel()
                elif not is_started:
                    is_started = True  # an interrupt within start() does not tell whether it has started
                    thread.start()
                if self._done.wait(POLL_S):
                    break
            except BaseException as error:  # KeyboardInterrupt, or what another handler raises
                if self._withdrawn:
                    raise
                interrupt = interrupt or error
        thread.join()
        if interrupt is not None:
            raise interrupt
        if self._error is not None:
            raise self._error


class _Bar:
    """Progress on stderr: a bar on a terminal, nothing elsewhere."""

    def __init__(self, show: Union[bool, Callable[[float, str], Any]]):
        self._show = show
        self._open = False

    def __call__(self, fraction: float, text: str) -> bool:
        if callable(self._show):
            return self._show(fraction, text) is False
        if self._show and sys.stderr.isatty():
            part = min(max(fraction, 0.0), 1.0)
            sys.stderr.write("\r[%-30s] %3d %%  %s\x1b[K" % ("#" * int(30 * part), int(100 * part), text))
            sys.stderr.flush()
            self._open = True
        return False

    def finish(self) -> None:
        if self._open:
            sys.stderr.write("\n")


class ReportedCall:
    """A long call with progress. What a function of the caller raises ends it, and is raised instead of its Error."""

    def __init__(self, show: Union[bool, Callable[[float, str], Any]]):
        self._bar = _Bar(show)
        self._raised: Optional[BaseException] = None

    def report(self, fraction: float, text: str) -> int:
        """For the callback of the library: 1 to cancel."""
        try:
            return int(self._bar(fraction, text))
        except BaseException as error:
            self._raised = self._raised or error
            return 1

    def make(self, call: Callable[[], Any], cancel: Callable[[], None]) -> None:
        def checked() -> None:
            try:
                call()
            except Error:
                if self._raised:
                    raise self._raised
                raise

        try:
            _InterruptibleCall(checked, cancel).wait()
        finally:
            self._bar.finish()
