"""Tables whose rows are measured in groups, by calls of ptexp that render nothing."""
import hashlib
import json
from dataclasses import asdict

from lib import harness
from lib.harness import HarnessError
from lib.journal import Journal
from lib.program import version_of
from lib.session import is_complete


def key_of(program, device, parts):
    """Equal for calls whose measurements may stand in one table."""
    facts = json.dumps([version_of(program), device.name, parts])
    return hashlib.sha256(facts.encode()).hexdigest()[:16]


def measure_table(experiment, arguments, program, device, *, kind, parts, groups):
    """(path of the table, its rows), or None for the rows if the table has been complete before.
    `parts`: what besides program and device makes another table; `groups`: as `kind` in the
    journal, (name, function that measures the rows)."""
    path = harness.table_path(experiment, device, arguments)
    key = key_of(program, device, parts)
    if not arguments.fresh and is_complete(path, key):
        print("measured already by this program and command (--fresh measures again)")
        return path, None
    journal = Journal(path.with_suffix(".journal"), key, arguments.fresh, lambda _: True)
    journal.begin(date=harness.now())
    facts = {**harness.provenance(experiment, program, device, arguments), "key": key,
             **({"plot": asdict(experiment.plot)} if experiment.plot else {})}

    def save(rows, complete=False):
        measured = measured_of(rows)
        if measured:
            experiment.finish(measured, arguments)
            harness.write_table(path, rows, {
                **facts, "complete": complete,
                "conclusions": experiment.conclude(measured, arguments)})
    rows = journal.measure_groups(kind, groups, save)
    measured = measured_of(rows)
    complete = not any(row["status"] == "failed" for row in rows)
    if measured:
        save(rows, complete=complete)
    if complete or not measured:
        journal.remove()
    if not measured:
        raise HarnessError(f"nothing was measured: {rows[0]['message']}; no result was written")
    return path, rows


def measured_of(rows):
    return [row for row in rows if row["status"] == "measured"]
