"""Claims on trial: judges those of experiments/claims by the tables of results/DEVICE.

A verdict is one of four. *Reproduced*: every case of the table is within the rule's bounds with its
whole interval. *Refuted*: some case is outside of them with its whole interval, and none within:
a claim without conditions speaks of all cases. *Holds only when*: some cases are within, some are
not. Else it *cannot be judged here*, as where intervals contain a bound, or the table is missing.
"""
import re
import sys
from dataclasses import dataclass, field

from lib.claim_files import CLAIMS, ClaimError, read_claims
from lib.claim_rules import cells_of, inside, outside
from lib.program import ROOT

sys.path.insert(0, str(ROOT / "scripts"))
# pylint: disable=wrong-import-position
from report_parts.words import listed, with_interval  # noqa: E402

MOST_NAMED = 4  # cases that a verdict lists by name where a description would be longer than
LONGEST = 300


@dataclass
class Verdict:
    kind: str  # "reproduced", "refuted", "holds only when" or "cannot be judged here"
    text: str  # begins with the kind
    numbers: str = ""
    commit: str = ""
    table: str = ""
    cells: list = field(default_factory=list)


def command_for(rule):
    """The command that makes the rule's table; that of NAME-LABEL is NAME's with the label."""
    name, _, label = rule["table"].partition("-")
    return rule.get("command") or f"experiments/{name}.py" + (f" --label {label}" if label else "")


def unjudged(why, **more):
    return Verdict("cannot be judged here", f"cannot be judged here: {why}", **more)


def name_of(cell):
    return ", ".join(text for text in cell.labels.values() if text)


def branch(cases, words):
    """The shortest description, by a decision tree over labels, of the cases that hold; "" if all
    do and None if none does. A case is (labels, whether it holds)."""
    if all(holds for _, holds in cases):
        return ""
    if not any(holds for _, holds in cases):
        return None
    found = []
    for word in words:
        groups = {}
        for labels, holds in cases:
            groups.setdefault(labels[word], []).append((labels, holds))
        below = {value: branch(group, [other for other in words if other != word])
                 for value, group in groups.items()}
        whole = [value for value, text in below.items() if text == ""]
        partly = [(value, text) for value, text in below.items() if text]
        none = [value for value, text in below.items() if text is None]
        if not partly and 0 < len(none) < len(whole):
            found.append(f"{word} is not {' or '.join(none)}")
        elif len(partly) == 1 and not whole:
            found.append(f"{word} is {partly[0][0]} and {partly[0][1]}")
        else:
            values = [" or ".join(whole)] * bool(whole) + [
                f"{value} ({text})" for value, text in partly]
            found.append(f"{word} is {', or '.join(values)}")
    return min(found, key=len)


def condition(within, others):
    """When it holds. Labels tell all cases apart, else there is no saying when."""
    words = list(within[0].labels)
    text = branch([(cell.labels, True) for cell in within]
                  + [(cell.labels, False) for cell in others], words) if words else "in some cases"
    count = f"({len(within)} of {len(within) + len(others)} cases)"
    if len(text) > LONGEST:
        named = "; ".join(map(name_of, within[:MOST_NAMED]))
        text = f"{named}" + ("; and others" if len(within) > MOST_NAMED else "")
    return f"{text} {count}"


def numbers_of(cells, rule):
    if rule["statistic"] == "measured":
        return f"{sum(cell.value.middle for cell in cells):g} of {len(cells)} cases ran"

    def one(cell):
        return with_interval(cell.value) + (f" ({name_of(cell)})" if name_of(cell) else "")
    ordered = sorted(cells, key=lambda cell: cell.value.middle)
    text = one(ordered[0]) if len(cells) == 1 else (
        f"{one(ordered[0])} to {one(ordered[-1])}, {len(cells)} cases")
    if any(cell.assumed for cell in cells):
        text += f"; interval assumed: {100 * rule['assumed_spread']:g} %"
    return text


def judge_cells(cells, rule):
    """(kind, text)"""
    within, without, unclear = [], [], []
    for cell in cells:
        (within if inside(cell.value, rule) else
         without if outside(cell.value, rule) else unclear).append(cell)
    if within and not without + unclear:
        return "reproduced", "reproduced"
    if within:
        return "holds only when", f"holds only when {condition(within, without + unclear)}"
    if without:
        return "refuted", "refuted" + (
            f" ({len(without)} of {len(cells)} cases; the others' intervals contain a bound)"
            if unclear else "")
    why = "the interval contains a bound" if len(cells) == 1 else "the intervals contain a bound"
    if not any(cell.value.known for cell in cells):
        why = "the table has no intervals"
    return "cannot be judged here", f"cannot be judged here: {why}"


def judge(claim, device):
    """The verdict on a claim by the tables of a device (report_parts.tables.Device)."""
    if claim.lacks:
        return unjudged(f"ptexp lacks {claim.lacks['what']}")
    rule = claim.rule
    table = device.tables.get(rule["table"]) or device.tables.get(f"{rule['table']}-quick")
    if table is None:
        return unjudged(f"no table {rule['table']}; {command_for(rule)} makes it")
    if table.facts.get("quick"):
        return unjudged(f"quick tables are not judged; {command_for(rule)} makes one that is")
    try:
        cells = cells_of(table, rule)
    except ValueError as error:
        raise ClaimError(f"{claim.name}.toml: rule on table {rule['table']}: {error}") from error
    if not cells:
        return unjudged(f"{rule['table']} has no such rows; "
                        f"{command_for(rule)} measures them")
    kind, text = judge_cells(cells, rule)
    commits = dict.fromkeys(commit for cell in cells for commit in cell.commits) or re.findall(
        r"commit (\w{7})", " ".join(table.facts.get("program", [])))
    return Verdict(kind, text, numbers_of(cells, rule), listed(commits), rule["table"], cells)


def judge_all(device, folder=CLAIMS):
    """[(claim, verdict)]"""
    return [(claim, judge(claim, device)) for claim in read_claims(folder)]
