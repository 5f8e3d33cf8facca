"""Makes a submission (lib/submission_files.py) of the tables that a tier of scripts/reproduce left."""
import re
import sys

from lib.claim_rules import inside
from lib.claims import judge_all
from lib.program import ROOT
from lib.submission_files import (ENDS, TIMES, VERSION, SubmissionError, check_submission)

sys.path.insert(0, str(ROOT / "scripts"))
# pylint: disable=wrong-import-position
from report_parts.first import drivers  # noqa: E402
from report_parts.modes import date_of, verdicts  # noqa: E402
from report_parts.tables import Device, read_table  # noqa: E402


def check_commit(lines, what):
    """`lines` of --version name a commit that others can build."""
    commit = re.search(r"(?m)^commit (\S+)$", "\n".join(lines))
    if not commit or not re.fullmatch("[0-9a-f]{7,40}", commit[1]):
        raise SubmissionError(f"{what} is of commit {commit[1] if commit else 'unknown'}; expected a "
                              "clean one, that others can build")


def check_table(table):
    """That it says how fast the program of a commit is."""
    facts, name = table.facts, table.name
    if not facts:
        raise SubmissionError(f"{name}.json is missing")
    if facts.get("quick"):
        raise SubmissionError(f"table {name} was made with --quick, which tells nothing of speed")
    check_commit(facts.get("program", []), f"table {name}")
    wrong = [row for row in table.rows if row.get("status", "measured") not in ("measured", "refused")]
    if facts.get("complete") is not True or wrong:
        why = f" ({wrong[0]['name']}: {wrong[0]['status']})" if wrong else ""
        raise SubmissionError(f"table {name} is incomplete{why}; the same command goes on")


def only(what, of_tables):
    """The value that all tables agree in. `of_tables`: {table: values}"""
    first = {}
    for name, values in of_tables.items():
        for value in values:
            first.setdefault(value, name)
    if len(first) > 1:
        raise SubmissionError(f"tables of several {what}s: " + ", ".join(
            f"{name} has {value}" for value, name in first.items()) + "; expected one")
    return next(iter(first), "")


def read_tables(folder, names):
    """The tables that the tier's experiments left in a device's folder."""
    tables = {}
    for name in names:
        path = folder / f"{name}.csv"
        if not path.is_file():
            raise SubmissionError(f"table {name} is missing; the same command goes on")
        tables[name] = read_table(path)
        check_table(tables[name])
    return tables


def value_of(value):
    return dict(zip(ENDS, (value.middle, value.low, value.high)))


def works_of(device):
    """Times and hashes as the tables have them."""
    found = []
    for work, verdict in verdicts(device).items():
        times = {mode: {**dict(zip(TIMES, (value.middle, value.low, value.high))),
                        "repeat": int(row["repeat"]), "rounds": int(row["rounds"])}
                 for mode, (value, row) in verdict.times.items()}
        found.append({"scene_hash": next(row["scene_hash"] for _, row in verdict.times.values()),
                      "width": work.width, "height": work.height, "spp": work.spp,
                      "max_depth": work.depth, "table": verdict.table.name, **times})
    return found


def claims_of(device):
    """Those that the tables judge. Cases have no names here: they may be names of files."""
    found = []
    for claim, verdict in judge_all(device):
        if verdict.cells:
            ordered = sorted(verdict.cells, key=lambda cell: cell.value.middle)
            found.append({"claim": claim.name, "verdict": verdict.kind, "table": verdict.table,
                          "cases": len(ordered),
                          "within": sum(inside(cell.value, claim.rule) for cell in ordered),
                          "least": value_of(ordered[0].value),
                          "greatest": value_of(ordered[-1].value)})
    return found


def submission_of(folder, names, tier):
    """The facts of a submission. Raises SubmissionError for tables that nobody should send."""
    tables = read_tables(folder, names)
    rows = {name: table.measured for name, table in tables.items()}

    def in_rows(column, where=lambda _: True):
        return {name: [row[column] for row in mine if row.get(column) and where(row)]
                for name, mine in rows.items()}
    said = {name: re.findall(r"(?m)^commit (\S+)$", "\n".join(table.facts["program"]))
            for name, table in tables.items()}
    commit = only("commit", {name: said[name] + found for name, found in in_rows("commit").items()})
    found = next(iter(tables.values())).facts
    kind = found["device"]["choice"].partition(":")[0]
    is_cpu = kind == "cpu"
    device = Device(folder, "", tables)
    facts = {
        "schema_version": VERSION,
        "tier": tier,
        "date": max(map(date_of, tables.values()))[:10],
        "program": {"version": only("version", in_rows("version")), "commit": commit,
                    "build_type": only("build type", in_rows("build_type")),
                    "cuda": only("toolkit", in_rows("cuda")),
                    "fast_math": only("setting of fast math", in_rows("fast_math"))},
        "device": {"name": found["host"]["cpu"] if is_cpu else only("device", {
                       name: [table.facts["device"]["name"]] for name, table in tables.items()}),
                   "kind": kind, "detail": found["device"]["detail"],
                   "driver": "" if is_cpu else only("driver", {
                       name: drivers(table) for name, table in tables.items()}),
                   "cuda": only("CUDA driver", in_rows(
                       "driver", lambda row: row.get("device_kind") == kind))},
        "works": works_of(device), "claims": claims_of(device)}
    try:
        check_submission(facts)
    except SubmissionError as error:
        raise SubmissionError(f"the tables of {folder} make no submission: {error}") from error
    return facts
