"""The files of a table: DIR/DEVICE/NAME.csv, and NAME.json that says where it comes from."""
import csv
import io
import json
import os
import tempfile

from lib.provenance import device_folder


def csv_text(rows):
    columns = list(dict.fromkeys(column for row in rows for column in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def renamed(column):
    """The column's name in this schema version: stage sort_hits was renamed in version 11."""
    return column.replace("sort_hits_", "route_hits_", 1) if column.startswith("sort_hits_") else column


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{renamed(column): value for column, value in row.items()}
                for row in csv.DictReader(file)]


def read_facts(path):
    """The JSON beside the table."""
    return json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))


def write_atomically(path, text):
    """Whoever reads the path sees the old file or the whole new one."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-", suffix=".tmp")
    try:
        with open(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def table_path(experiment, device, arguments):
    """The table's file; its folder is made now, not after the measurement."""
    folder = arguments.output / device_folder(device)
    folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{experiment.name}{'-' if arguments.label else ''}{arguments.label}.csv"


def write_table(path, rows, facts):
    write_atomically(path.with_suffix(".json"), json.dumps(facts, indent=2) + "\n")
    write_atomically(path, csv_text(rows))


def table_text(rows, labels):
    """The table for people: name, times, rate and the experiment's own labels."""
    def number(row, column):
        return f"{float(row[column]):.4g}" if row.get(column) else ""
    lines = [["", "median ms", "low ms", "high ms", "Mpaths/s", *labels]]
    for row in rows:
        if row["status"] == "measured":
            times = [number(row, f"kernel_ms_{part}") for part in ("median", "low", "high")]
            lines.append([row["name"], *times, number(row, "mpaths_per_s"),
                          *(number(row, label) if label.endswith("_ms") else
                            str(row.get(label, "")) for label in labels)])
        else:
            lines.append([row["name"], row["status"], "", "", "", *[""] * len(labels)])
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join("  ".join([line[0].ljust(widths[0]),
                                *(text.rjust(w) for text, w in zip(line[1:], widths[1:]))]).rstrip()
                     for line in lines)
