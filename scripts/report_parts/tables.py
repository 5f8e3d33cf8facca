"""Reads results/DEVICE/NAME.csv with the NAME.json beside it. Columns are found by their names, so
that tables of all schema versions can be read; what is not there is empty."""
import csv
import json
import re
from dataclasses import dataclass, field
from pathlib import Path

from .shared import intervals

OLD_NAMES = {"by_itself": "defaults"}  # of tables, in the release before
BASES = ("default", "no other change")  # rows that the others of their panel differ from by one thing
CONFIDENCE = "confidence interval"
RANGE = "fastest to slowest repeat"
Interval = intervals.Interval


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def is_measured(row):
    return row.get("status", "measured") == "measured"


def interval(row, column):
    """The value of a column with its interval, None if it was not measured. A row that was
    repeated once has no interval, even if its table has columns for it."""
    middle = number(row.get(f"{column}_median"))
    if middle is None:
        middle = number(row.get(column))
    if middle is None:
        return None
    stem = column[:-3] if column.endswith("_ms") else column
    for low, high, kind in ((f"{column}_low", f"{column}_high", CONFIDENCE),
                            (f"{column}_min", f"{column}_max", RANGE),
                            (f"{stem}_min_ms", f"{stem}_max_ms", RANGE)):
        ends = number(row.get(low)), number(row.get(high))
        if None not in ends and not (ends[0] == ends[1] and row.get("repeat") == "1"):
            return Interval(middle, *ends, kind)
    return Interval(middle)


@dataclass
class Table:
    name: str
    columns: list
    rows: list
    facts: dict = field(default_factory=dict)  # of the JSON; empty: there is none

    @property
    def measured(self):
        return [row for row in self.rows if is_measured(row)]

    @property
    def plot(self):
        return self.facts.get("plot")

    @property
    def drawn(self):
        """Rows with a place in the plot."""
        return [row for row in self.rows if row.get("x")] if self.plot else []

    @property
    def commits(self):
        return list(dict.fromkeys(row["commit"] for row in self.rows if row.get("commit")))

    @property
    def kind(self):
        """What the intervals of the plot are."""
        kinds = {value.kind for row in self.measured if self.plot
                 for value in [interval(row, self.plot["y"])] if value and value.known}
        return " or ".join(sorted(kinds))


def in_groups(rows, *labels):
    """{values of the labels: rows}, in the order of the table."""
    groups = {}
    for row in rows:
        key = tuple(row.get(label, "") for label in labels)
        groups.setdefault(key if len(labels) > 1 else key[0], []).append(row)
    return groups


def style_of(table, panel):
    """How a panel is drawn: an axis without a label has the panel's name."""
    return {**table.plot, "x_label": table.plot.get("x_label") or panel}


def plot_title(facts):
    """The plot's title. The sizes in it, behind the colon, are not those of --quick."""
    title = facts["plot"].get("title") or facts.get("experiment", "")
    if not facts.get("quick"):
        return title
    return f"{title.partition(':')[0]} (quick: small images, not for comparison)"


def give_ray_sets_a_plot(table):
    """Tables of `ptexp trace` have no description of a plot: bars, a panel for each set of rays."""
    for row in table.rows:
        rays = row["ray_file"].removesuffix(".rays")
        row["panel"], _, row["series"] = rays, "", ""
        row["x"] = ", ".join(row[label] for label in ("accel", "builder", "variant") if row[label])
    table.facts["plot"] = {"kind": "bars", "title": "Tracing alone", "x_label": "", "y": "time_ms",
                           "y_label": "time of the rays [ms]", "log_y": False}


def renamed(column):
    """The column's name in this schema version: stage sort_hits was renamed in version 11."""
    return column.replace("sort_hits_", "route_hits_", 1) if column.startswith("sort_hits_") else column


# No XML has them, or they turn the direction of what follows.
UNPRINTABLE = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
                         "\ud800-\udfff\ufffe\uffff]")


def printable(value):
    """The same JSON without characters that no page can show."""
    if isinstance(value, str):
        return UNPRINTABLE.sub("?", value)
    if isinstance(value, list):
        return [printable(one) for one in value]
    if isinstance(value, dict):
        return {printable(key): printable(one) for key, one in value.items()}
    return value


def read_table(path):
    path = Path(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            rows = printable([{renamed(key): value or "" for key, value in row.items() if key}
                              for row in reader])
            columns = printable([renamed(column) for column in reader.fieldnames or []])
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}: not a table of CSV in UTF-8: {error}") from error
    facts = {}
    description = path.with_suffix(".json")
    if description.is_file():
        try:
            facts = printable(json.loads(description.read_text(encoding="utf-8")))
        except ValueError as error:
            raise ValueError(f"{description}: not JSON: {error}") from error
        if not isinstance(facts, dict):
            raise ValueError(f"{description}: expected an object")
    name = printable(path.stem)
    table = Table(OLD_NAMES.get(name, name), columns, rows, facts)
    if facts and not table.plot and {"ray_file", "time_ms", "accel"} <= set(columns):
        give_ray_sets_a_plot(table)
    return table


@dataclass
class Device:
    folder: Path
    name: str
    tables: dict  # by name
    silent: dict = None  # by name, why a table neither is shown nor speaks (modes.silent)

    def to_judge(self, name):
        """A table that answers may rest on: not one of small images, nor a silent one."""
        table = self.tables.get(name)
        return None if table and (table.facts.get("quick") or name in (self.silent or ())) else table


def unmeasured(device, names, text):
    """`text`, which says that there is no table of the experiments `names`; unless there are some of
    small images."""
    quick = sorted({table.facts.get("experiment", table.name) for table in device.tables.values()
                    if table.facts.get("quick")} & set(names))
    if not quick:
        return text
    return (f"Quick tables are not judged, and of {' and '.join(quick)} there is no other: without "
            "--quick the experiment makes one.")


def read_device(folder):
    folder = Path(folder)
    if not folder.is_dir():
        raise ValueError(f"{folder}: no such folder; a folder of results/ was expected")
    # Sorted, so that `defaults` comes after its old name and replaces it.
    tables = {table.name: table for table in map(read_table, sorted(folder.glob("*.csv")))}
    if not tables:
        raise ValueError(f"{folder}: no tables; *.csv of the experiments were expected")
    names = [table.facts["device"]["name"] for table in tables.values()
             if table.facts.get("device")]
    return Device(folder, names[0] if names else printable(folder.name), tables)
