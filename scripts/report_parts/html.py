"""Tables in HTML that sort by a click, and small pieces of the page."""
from html import escape

from .tables import number
from .words import show

MEASURES = ["kernel_ms_median", "kernel_ms_low", "kernel_ms_high", "kernel_ms_min",
            "kernel_ms_max", "time_ms", "time_min_ms", "time_max_ms", "mpaths_per_s",
            "mrays_per_s", "waves", "memory_bytes"]
RAY_SETS = ["mesh", "ray_file", "accel", "builder", "variant", "build_ms", "bytes_per_triangle"]
NOT_SHOWN = {"experiment"}
# Where tables without a schema version, whose columns are their experiment's, say what was measured.
ORIGIN = {"version", "commit", "build_type", "compiler", "cuda", "fast_math", "command", "device",
          "device_kind", "threads", "driver", "repeat", "warmup", "scene_hash"}
MOST_ROWS = 150  # of a table; the file has all


def cell(text):
    """A number shows four digits and keeps all of them for sorting and reading."""
    value = number(text)
    if value is None or not value == value:  # NaN sorts nowhere
        return f"<td{' class=long' * (len(text) > 60)}>{escape(text)}</td>"
    shown = f"{value:,.0f}" if value == int(value) and abs(value) < 1e15 else show(value, 4)
    title = f' title="{escape(text)}"' if shown != text else ""
    return f'<td class="n" data-v="{escape(text)}"{title}>{shown}</td>'


def html_table(heads, rows, name=""):
    """`rows` of texts, or of cells that are HTML already (they begin with <td)."""
    rows = [[text if text.startswith("<td") else cell(text) for text in row] for row in rows]
    right = [any(row[column].startswith('<td class="n"') for row in rows)
             for column in range(len(heads))]
    head = "".join(f'<th scope="col"{" class=n" * is_number}><button type="button">{escape(head)}'
                   "</button></th>" for head, is_number in zip(heads, right))
    body = "".join(f"<tr>{''.join(row)}</tr>\n" for row in rows)
    return (f'<div class="scroll {name}"><table class="sortable"><thead><tr>{head}</tr></thead>'
            f"<tbody>\n{body}</tbody></table></div>")


def verdict_cell(word):
    name = {"slower": "bad", "faster": "good", "refuted": "bad", "confirmed": "good",
            "depends": "mixed"}.get(word, "quiet")
    return f'<td><span class="verdict {name}">{escape(word)}</span></td>'


def varies(table, column):
    return len({row.get(column, "") for row in table.rows}) > 1


def is_in_the_name(table, column):
    return column in ("series", "panel") and all(
        row[column] and row[column] in row.get("name", "") for row in table.rows)


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


def table_of(table):
    columns = columns_shown(table)
    text = html_table([column.replace("_", " ") for column in columns],
                      [[row[column] for column in columns] for row in table.rows[:MOST_ROWS]])
    if len(table.rows) > MOST_ROWS:
        text += (f'<p class="note">The first {MOST_ROWS} of {len(table.rows)} rows; '
                 f"{escape(table.name)}.csv has all.</p>")
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
            f"{html_table(heads, rows)}</details>")


def paragraph(text):
    return f"<p>{escape(text)}</p>"


def facts_list(pairs):
    return "<dl>" + "".join(f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>"
                            for name, text in pairs if text) + "</dl>"
