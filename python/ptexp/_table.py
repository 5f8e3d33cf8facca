"""Tables of times: what ptexp.measure and ptexp.sweep return."""
import html
from typing import Any, Dict, Iterable, List, Tuple

from ._errors import Error
from ._intervals import Interval, Rounds


class Table(List[Dict[str, Any]]):
    """Times: a list with a dictionary for each row. Prints, and shows in notebooks, as a table.

    ================================  ==================================================
    the swept options, ``mode``       what distinguishes the row
    ``stage``                         with ``by_stage=True``: a stage, or "all" of them
    ``time_ms``                       median time of a render, as its statistics' ``kernel_ms``; of a stage
    ``low_ms``, ``high_ms``           95 % interval of the median, by bootstrap; None of a single repeat
    ``min_ms``, ``max_ms``            the fastest and the slowest repeat
    ``mrays_per_s``                   rays and shadow rays per median time, 10^6/s; None of a stage
    ``paths``, ``rays``, ``shadow_rays``  how many the render traced
    ``repeat``                        measured renders
    ``rounds_ms``                     the times of each round, a list of lists
    ``device``                        its name
    ================================  ==================================================
    """

    def __init__(self, rows: Iterable[Dict[str, Any]] = (), labels: Tuple[str, ...] = ("mode",)) -> None:
        super().__init__(rows)
        self.labels = labels  #: the columns that distinguish rows

    def dataframe(self) -> Any:
        """The rows as a ``pandas.DataFrame``.

        Raises:
            Error: pandas is not installed.
        """
        try:
            import pandas  # type: ignore
        except ImportError:
            raise Error("dataframe: needs pandas, which is not installed") from None
        return pandas.DataFrame(list(self))

    def plot(self, axes: Any = None) -> Any:
        """Draws the times by matplotlib: lines over the first swept option that has several numbers,
        else bars, of stages bars in parts. Whiskers are the intervals.

        Args:
            axes: where to draw; None: in a new figure.

        Returns:
            The axes.

        Raises:
            Error: matplotlib is not installed.
        """
        try:
            import matplotlib.pyplot as plt
        except ImportError:
            raise Error("plot: needs matplotlib, which is not installed") from None
        axes = plt.subplots()[1] if axes is None else axes
        over = self._number_label()
        if any("stage" in row for row in self):
            self._draw_stages(axes)
        elif over is not None:
            self._draw_lines(axes, over)
        else:
            self._draw_bars(axes)
        return axes

    def _number_label(self) -> Any:
        """The first label with several values, all of them numbers."""
        for label in self.labels:
            values = {row[label] for row in self}
            if len(values) > 1 and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in values):
                return label
        return None

    def _names(self, row: Dict[str, Any], but: Tuple[str, ...] = ()) -> str:
        """The labels of a row in which rows differ; modes by their names alone."""
        differing = [label for label in self.labels if label not in but and len({str(r[label]) for r in self}) > 1]
        texts = [str(row[label]) if label == "mode" else f"{label} {row[label]}" for label in differing]
        return ", ".join(texts) or ("" if but else str(row["mode"]))

    def _draw_lines(self, axes: Any, over: str) -> None:
        series: Dict[str, List[Dict[str, Any]]] = {}
        for row in self:
            series.setdefault(self._names(row, (over,)), []).append(row)
        for name, rows in series.items():
            rows = sorted(rows, key=lambda row: row[over])
            axes.errorbar([row[over] for row in rows], [row["time_ms"] for row in rows], _whiskers(rows),
                          marker="o", capsize=3, label=name or None)
        if any(series):
            axes.legend()
        axes.set_xlabel(over), axes.set_ylabel("ms"), axes.set_ylim(bottom=0)

    def _draw_bars(self, axes: Any) -> None:
        axes.barh([self._names(row) for row in self], [row["time_ms"] for row in self], xerr=_whiskers(self), capsize=3)
        axes.invert_yaxis(), axes.set_xlabel("ms")

    def _draw_stages(self, axes: Any) -> None:
        rows = [row for row in self if row["stage"] != "all"]
        names = list(dict.fromkeys(self._names(row) for row in rows))
        left = dict.fromkeys(names, 0.0)
        for stage in dict.fromkeys(row["stage"] for row in rows):
            mine = {self._names(row): row["time_ms"] for row in rows if row["stage"] == stage}
            axes.barh(list(mine), list(mine.values()), left=[left[name] for name in mine], label=stage)
            for name, time_ms in mine.items():
                left[name] += time_ms
        axes.invert_yaxis(), axes.set_xlabel("ms"), axes.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1, 1))

    def _cells(self) -> List[List[str]]:
        """The table as text, its head first."""
        labels = [*self.labels, *(["stage"] if any("stage" in row for row in self) else [])]
        head = [*labels, "ms", "95 % interval", "Mrays/s"]
        return [head, *([*(str(row[label]) for label in labels), f"{row['time_ms']:.4g}",
                         interval_text(row["low_ms"], row["high_ms"]),
                         "" if row["mrays_per_s"] is None else f"{row['mrays_per_s']:.4g}"] for row in self)]

    def __repr__(self) -> str:
        cells = self._cells()
        widths = [max(map(len, column)) for column in zip(*cells)]
        is_text = [column < len(widths) - 3 for column in range(len(widths))]
        return "\n".join("  ".join(cell.ljust(width) if text else cell.rjust(width)
                                   for cell, width, text in zip(row, widths, is_text)).rstrip() for row in cells)

    def _repr_html_(self) -> str:
        head, *rows = ([html.escape(cell) for cell in row] for row in self._cells())
        lines = ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
        return "\n".join(["<table><tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr>", *lines, "</table>"])


def interval_text(low: Any, high: Any) -> str:
    return "" if low is None else f"[{low:.4g}, {high:.4g}]"


def interval_of(row: Dict[str, Any]) -> Interval:
    return Interval(row["time_ms"], row["low_ms"], row["high_ms"])


def rounds_of(row: Dict[str, Any]) -> Rounds:
    return tuple(map(tuple, row["rounds_ms"]))


def _whiskers(rows: List[Dict[str, Any]]) -> Any:
    """Lengths below and above the medians."""
    if any(row["low_ms"] is None for row in rows):
        return None
    return [[row["time_ms"] - row["low_ms"] for row in rows], [row["high_ms"] - row["time_ms"] for row in rows]]
