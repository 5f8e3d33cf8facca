"""Other devices on the page: what others sent (experiments/lib/submission_files.py) beside the page's
own devices."""
import sys
from pathlib import Path

from .claims import COLOURS, judge_all
from .html import Cell, html_table, value_cell, verdict_cell
from .modes import Work, verdicts

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "experiments"))
# pylint: disable=wrong-import-position
from lib.claim_rules import inside  # noqa: E402
from lib.submission_files import column_names, read_submissions  # noqa: E402,F401

NONE = Cell("<td></td>")


def heads_of(devices, submissions):
    return [*(f"{device.name}, this page" for device in devices), *column_names(submissions)]


def own_ratios(device):
    """{work: (our name of its scene, ratio)}; works as submissions name them, by the scene's hash."""
    found = {}
    for work, verdict in verdicts(device).items():
        scene = next(row.get("scene_hash") or work.scene for _, row in verdict.times.values())
        named = Work(scene.removeprefix("built-in "), work.width, work.height, work.spp, work.depth)
        found[named] = work.scene, verdict.ratio
    return found


def works_table(devices, submissions):
    own = [own_ratios(device) for device in devices]
    theirs = [one.ratios() for one in submissions]
    rows = []
    for work in sorted({work for found in theirs for work in found}, key=str):
        name = next((found[work][0] for found in own if work in found), work.scene)
        rows.append([name, work.size, str(work.spp), str(work.depth)]
                    + [value_cell(found[work][1]) if work in found else NONE for found in own]
                    + [value_cell(found[work][0]) if work in found else NONE for found in theirs])
    heads = ["scene", "image", "samples", "depth", *heads_of(devices, submissions)]
    return html_table(heads, rows, "works", "Time of the megakernel / time of the wavefront")


def verdict_in_cases(kind, within, cases):
    return verdict_cell(f"{kind} ({within} of {cases} cases)", COLOURS[kind])


def own_claims(device):
    return {claim.name: verdict_in_cases(verdict.kind, sum(
        inside(cell.value, claim.rule) for cell in verdict.cells), len(verdict.cells))
            for claim, verdict in judge_all(device) if verdict.cells}


def verdicts_table(devices, submissions):
    theirs = [{name: verdict_in_cases(*(found[key] for key in ("verdict", "within", "cases")))
               for name, found in one.claims().items()} for one in submissions]
    columns = [own_claims(device) for device in devices] + theirs
    rows = [[claim, *(found.get(claim, NONE) for found in columns)]
            for claim in sorted({claim for found in theirs for claim in found})]
    return html_table(["claim", *heads_of(devices, submissions)], rows, "judged",
                      "Verdicts, and the cases within the rule's bounds")


def other_devices(devices, submissions):
    """A section; nothing where nobody has sent anything."""
    if not submissions:
        return ""
    judged = (verdicts_table(devices, submissions) if any(one.claims() for one in submissions)
              else "")
    return ('\n<section id="devices">\n<h2>Other devices</h2>\n<p class="question">What others '
            "measured and sent, by the same program, each scene with the same files. Ratios have the "
            f"interval that the ends of both times allow.</p>\n{works_table(devices, submissions)}"
            f"\n{judged}\n</section>")
