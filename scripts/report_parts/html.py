"""Tables in HTML that sort by a click, and small pieces of the page."""
import re
from html import escape
from urllib.parse import quote

from .modes import how, mode_of, work_of
from .tables import interval, number
from .words import show, with_interval

MEASURES = ["kernel_ms_median", "time_ms", "mpaths_per_s", "mrays_per_s"]
RAY_SETS = ["mesh", "ray_file", "accel", "builder", "variant", "build_ms", "bytes_per_triangle"]
# The file has them; the ends of an interval stand beside its median.
NOT_SHOWN = {"experiment", "kernel_ms_runs", "wall_ms_runs", "process_wall_ms_runs", "scene_hash",
             "rounds", "message", "alive", "command"}
ENDS = re.compile(r"(.+)_(?:low|high|min|max)(_ms)?")
# Where tables without a schema version, whose columns are their experiment's, say what was measured.
ORIGIN = {"version", "commit", "build_type", "compiler", "cuda", "fast_math", "command", "device",
          "device_kind", "threads", "driver", "repeat", "warmup", "scene_hash"}
MOST_ROWS = 150  # of a table; the file has all
OPEN_ROWS = 40  # longer tables are folded away, and paper names their files alone


class Cell(str):
    """HTML of a <td> that this program has made. All other texts are escaped."""


def cell(text):
    """A number shows four digits and keeps all of them for sorting and reading."""
    value = number(text)
    if value is None or not value == value:  # NaN sorts nowhere
        return Cell(f"<td{' class=long' * (len(text) > 60)}>{escape(text)}</td>")
    shown = f"{value:,.0f}" if value == int(value) and abs(value) < 1e15 else show(value, 4)
    title = f' title="{escape(text)}"' if shown != text else ""
    return Cell(f'<td class="n" data-v="{escape(text)}"{title}>{shown}</td>')


def value_cell(value, text=None, digits=3, more=""):
    """A value with its interval; `text`: with all digits. `more` are attributes: a cell that says
    of which work its value is has the ends of the interval for tests, too."""
    if more and value.known:
        more += f' data-low="{value.low!r}" data-high="{value.high!r}"'
    return Cell(f'<td class="n" data-v="{escape(text or repr(value.middle))}"{more}>'
                f"{with_interval(value, digits=digits)}</td>")


def work_attributes(table, row, column):
    """Attributes of a cell with the time of a work: which work, options and mode it is of."""
    work = work_of(row) if column == "kernel_ms_median" else None
    return (f' data-work="{escape(str(work))}" data-how="{how(table, row)}" '
            f'data-mode="{escape(mode_of(row))}"') if work else ""


def row_head(text):
    return '<th scope="row"' + text[3:].removesuffix("</td>") + "</th>"


def html_table(heads, rows, name="", caption="", rich=""):
    """`rows` of texts and Cells. The first of a row is its head. `rich` is HTML behind the caption."""
    rows = [[row_head(text) if column == 0 else text for column, text in enumerate(row)] for row in [
        [text if isinstance(text, Cell) else cell(text) for text in row] for row in rows]]
    right = [any(row[column].startswith('<td class="n"') for row in rows)
             for column in range(len(heads))]
    head = "".join(f'<th scope="col"{" class=n" * is_number}><button type="button">{escape(head)}'
                   "</button></th>" for head, is_number in zip(heads, right))
    body = "".join(f"<tr>{''.join(row)}</tr>\n" for row in rows)
    label = escape(caption or ", ".join(heads))
    title = f"<caption>{escape(caption)}{rich}</caption>" if caption else ""
    return (f'<div class="scroll {name}" tabindex="0" role="region" aria-label="{label}">'
            f'<table class="sortable">{title}<thead><tr>{head}</tr></thead>'
            f"<tbody>\n{body}</tbody></table></div>")


def verdict_cell(word, name=""):
    name = name or {"slower": "bad", "faster": "good"}.get(word, "quiet")
    return Cell(f'<td><span class="verdict {name}">{escape(word)}</span></td>')


def varies(table, column):
    return len({row.get(column, "") for row in table.rows}) > 1


def is_in_the_name(table, column):
    """Texts that each row's name repeats: the table names its rows once."""
    return column != "name" and any(row[column] for row in table.rows) and all(
        number(row[column]) is None and row[column] in row.get("name", "") for row in table.rows)


def columns_shown(table):
    """The experiment's own columns and the measures, without those that say nothing."""
    end = table.columns.index("schema_version") if "schema_version" in table.columns else None
    if end is None and not table.facts:
        return table.columns
    own = (table.columns[:end] if end is not None else
           RAY_SETS if "ray_file" in table.columns else
           [column for column in table.columns if column not in ORIGIN])
    shown = [column for column in own if column in table.columns and column not in NOT_SHOWN
             and not is_in_the_name(table, column)
             and (varies(table, column) or (len(table.rows) == 1 and table.rows[0][column]))]
    return list(dict.fromkeys(shown + [column for column in MEASURES if column in table.columns
                                       and any(row[column] for row in table.rows)]))


def measure_of(table, row, column):
    """The cell of a column: a median with the interval that other columns have."""
    stem = column.removesuffix("_median")
    value = interval(row, stem) if column.endswith(("_median", "_ms")) else None
    if value is None or not value.known or not any(ENDS.fullmatch(c) for c in table.columns):
        return row[column]
    return value_cell(value, row[column], 4, work_attributes(table, row, column))


def without_ends(table, columns):
    """Less the columns that are the ends of another one's interval."""
    def is_an_end(column):
        found = ENDS.fullmatch(column)
        return found and any(f"{found[1]}{rest}" in table.columns
                             for rest in ("_median", found[2] or ""))
    return [column for column in columns if column not in NOT_SHOWN and not is_an_end(column)]


def caption_of(table):
    """What the table is and which commit it is of: tables of one page may be of several."""
    parts = [f"{table.name}.csv, {len(table.rows)} rows"]
    commits = [commit[:7] for commit in table.commits] or re.findall(
        r"commit (\w{7})", " ".join(table.facts.get("program", [])))
    parts.append(f"measured at commit{'s' * (len(commits) > 1)} " + ", ".join(commits)
                 if commits else "names no commit")
    if table.facts.get("date"):
        parts.append(table.facts["date"][:10])
    return "; ".join(parts)


def table_of(table):
    columns = without_ends(table, columns_shown(table))
    text = html_table([column.replace("_", " ") for column in columns],
                      [[measure_of(table, row, column) for column in columns]
                       for row in table.rows[:MOST_ROWS]],
                      "long" * (len(table.rows) > OPEN_ROWS), caption_of(table),
                      f'. <a href="{quote(table.name, safe="")}.csv">All columns</a>')
    if len(table.rows) > MOST_ROWS:
        text += (f'<p class="note">The first {MOST_ROWS} of {len(table.rows)} rows; '
                 f"{escape(table.name)}.csv has all.</p>")
    if len(table.rows) > OPEN_ROWS:
        text = (f"<details><summary>{escape(caption_of(table))}</summary>{text}</details>"
                f'<p class="paper-only">{escape(caption_of(table))}: in the file.</p>')
    return text


def stages_of(table):
    """Where the time goes: the stages' medians, folded away. Empty where nothing says it."""
    stages = [column for column in table.columns if column.endswith("_ms_median")
              and column not in ("kernel_ms_median", "image_ms_median")
              and any(number(row[column]) for row in table.rows)]
    if not stages or "name" not in table.columns:
        return ""
    rows = [[row["name"], *(row[stage] for stage in stages)] for row in table.measured]
    heads = ["name", *(stage.removesuffix("_ms_median").replace("_", " ") for stage in stages)]
    return ("<details><summary>Where the time goes: stages, ms</summary>"
            f"{html_table(heads, rows, 'long', f'{table.name}: stages, median ms')}</details>")


def paragraph(text):
    return f"<p>{escape(text)}</p>"


def facts_list(pairs):
    return "<dl>" + "".join(f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>"
                            for name, text in pairs if text) + "</dl>"
