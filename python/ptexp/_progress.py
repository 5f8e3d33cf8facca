"""What ``progress=`` shows."""
import sys
import time
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any, Callable, Iterator, Optional, Union

from ._image import _is_notebook as is_notebook

Progress = Union[bool, Callable[[int, int], Any], None]


class _Line:
    """A line that is written anew: where tqdm is not installed."""

    def __init__(self, total: int) -> None:
        self.total, self.begin, self.width = total, time.monotonic(), 0

    def show(self, done: int) -> None:
        share = done / self.total if self.total else 1.0
        elapsed = time.monotonic() - self.begin
        left = f", about {elapsed / share - elapsed:.0f} s left" if 0 < share < 1 else ""
        text = f"{100 * share:.0f} % after {elapsed:.0f} s{left}"
        sys.stderr.write("\r" + text.ljust(self.width))
        sys.stderr.flush()
        self.width = len(text)

    def close(self) -> None:
        sys.stderr.write("\n")
        sys.stderr.flush()


class _Tqdm:
    """The bar of tqdm: its own in notebooks that have the widgets for it."""

    def __init__(self, total: int, unit: str) -> None:
        if is_notebook() and find_spec("ipywidgets"):
            from tqdm.notebook import tqdm  # type: ignore
        else:
            from tqdm.std import tqdm  # type: ignore
        self.bar = tqdm(total=total, unit=" " + unit, unit_scale=True)

    def show(self, done: int) -> None:
        self.bar.update(done - self.bar.n)

    def close(self) -> None:
        self.bar.close()


class _Bar:
    """Called with what is done and wanted. A repeat that begins again gets its own."""

    def __init__(self, unit: str) -> None:
        self.unit, self.done, self.shown = unit, 0, None  # type: str, int, Any

    def __call__(self, done: int, total: int) -> None:
        if self.shown is None or done < self.done:
            self.close()
            self.shown = _Tqdm(total, self.unit) if find_spec("tqdm") else _Line(total)
        self.done = done
        self.shown.show(done)

    def close(self) -> None:
        if self.shown is not None:
            self.shown.close()
        self.shown = None


@contextmanager
def shown(progress: Progress, unit: str) -> Iterator[Optional[Callable[[int, int], Any]]]:
    """What to call with (done, total) for a ``progress``; None: nothing. True shows a bar where
    somebody sees it, in a terminal or a notebook; it stays when the work ends or is ended."""
    if not isinstance(progress, bool):
        yield progress
        return
    if not (progress and (is_notebook() or sys.stderr.isatty())):
        yield None
        return
    bar = _Bar(unit)
    try:
        yield bar
    finally:
        bar.close()
