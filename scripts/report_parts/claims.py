"""The claims of experiments/claims and their verdicts by the tables of a device: on the report's
page, and as the site's page in Markdown."""
import sys
from html import escape
from pathlib import Path

from .html import Cell, html_table, verdict_cell

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "experiments"))
from lib.claims import judge_all  # noqa: E402  pylint: disable=wrong-import-position

COLOURS = {"reproduced": "good", "refuted": "bad", "holds only when": "mixed",
           "cannot be judged here": "quiet"}
HEADS = ["claim", "source", "verdict", "our number", "conditions", "table, commit"]


def lines_of(claim, verdict):
    """The six texts of a claim, each with those in small print below it."""
    named = f"Number: {claim.number}." if claim.number else "No number."
    read = "Source read" if claim.source_read else "Source not read as a whole"
    measured = (f"{claim.rule['measures']}; bound: {claim.bounds}" if claim.rule else
                f"It would take {claim.lacks['takes']}.")
    origin = ", ".join(part for part in (verdict.table, verdict.commit) if part)
    return [(claim.claim, named), (claim.citation, f"{read}: {claim.source_note}"),
            (verdict.text, ""), (verdict.numbers, measured),
            (claim.conditions, f"Ours: {claim.ours}"), (origin, "")]


def cell(text, small):
    below = f"<small>{escape(small)}</small>" if small else ""
    return Cell(f"<td>{escape(text)}{below}</td>")


def claims_table(device):
    rows = []
    for claim, verdict in judge_all(device):
        cells = [cell(*texts) for texts in lines_of(claim, verdict)]
        cells[2] = verdict_cell(verdict.text, COLOURS[verdict.kind])
        rows.append(cells)
    return html_table(HEADS, rows, "claims", "Claims and verdicts, by experiments/claims/*.toml")


def summary(judged):
    """'35 claims: 8 reproduced, ...'"""
    kinds = [verdict.kind for _, verdict in judged]
    return f"{len(kinds)} claims: " + ", ".join(
        f"{kinds.count(kind)} {kind}{' ...' * (kind == 'holds only when')}" for kind in COLOURS) + "."


def in_a_table(text):
    """Markdown that shows the text in a cell."""
    return text.replace("|", "\\|").replace("*", "\\*").replace("<", "&lt;") or "-"


def markdown(device):
    """The site's page."""
    judged = judge_all(device)
    lines = ["# Claims on trial", "",
             "After this page you know what others claim about GPU path tracing and what ptexp's "
             f"tables say to it, on one {device.name}. {summary(judged)}", "",
             "A claim is reproduced where each case is within the rule's bounds with its whole "
             "interval, and refuted where some case is outside and none within. Bounds, what "
             "differs in our experiment and which sources were read are in the "
             "[report](report.md). Adding a claim is adding a file to `experiments/claims`.", "",
             " | ".join(HEADS), " | ".join(["---"] * len(HEADS))]
    lines += [" | ".join(in_a_table(text) for text, _ in lines_of(claim, verdict))
              for claim, verdict in judged]
    return "\n".join(lines) + "\n"
