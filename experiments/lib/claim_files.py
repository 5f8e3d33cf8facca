"""Reads experiments/claims/*.toml, each what somebody says, where, and a rule that judges it:

    claim, citation, number, conditions   in our words; `number` is what the source names
    source_read, source_note              whether we read it as a whole, and which part or why not
    ours                                  how our experiment differs from theirs
    [rule]                                KEYS below; or
    [lacks] what, takes                   what ptexp lacks to judge it, and what it would take

Anything else in a file is an error that names file and key.
"""
from dataclasses import dataclass, field
from pathlib import Path

from lib.program import ROOT

CLAIMS = ROOT / "experiments" / "claims"
TEXT, TRUTH, NUMBER = "a text", "true or false", "a number"
COLUMNS, SELECTION = "texts", "a selection"
OF_CLAIM = {"claim": TEXT, "citation": TEXT, "number": TEXT, "conditions": TEXT, "ours": TEXT,
            "source_read": TRUTH, "source_note": TEXT}
OF_LACKS = {"what": TEXT, "takes": TEXT}
# What a rule may have besides what it must have.
NEEDED = {"table": TEXT, "measures": TEXT}
STATISTICS = ("ratio", "steps", "exponent", "value", "measured")
KEYS = {**NEEDED,
        "statistic": TEXT,          # one of STATISTICS; "ratio" if not given
        "column": TEXT,             # "kernel_ms" if not given
        "where": SELECTION,         # {column: pattern or patterns} of the rows that count
        "numerator": SELECTION, "denominator": SELECTION,  # of ratios; the fastest row if several
        "for_each": COLUMNS,        # {our word: column}: rows that agree in these are one case
        "vary": COLUMNS,            # likewise, of the numerator alone
        "along": TEXT,              # column of numbers: of steps and exponents
        "last_of": TEXT,            # only the rows with a case's highest number in this column
        "times": TEXT, "per": TEXT,  # columns: values are multiplied by one, divided by the other
        "at_least": NUMBER, "at_most": NUMBER,
        "assumed_spread": NUMBER,   # of values without an interval: the value times 1 -+ this
        "assumed_because": TEXT,
        "command": TEXT}            # that makes the table; found from the table's name if not given


class ClaimError(ValueError):
    """A file of experiments/claims is not as it should be."""


@dataclass
class Claim:
    name: str  # of the file
    claim: str
    citation: str
    number: str
    conditions: str
    ours: str
    source_read: bool
    source_note: str
    rule: dict = field(default_factory=dict)
    lacks: dict = field(default_factory=dict)

    @property
    def bounds(self):
        """Those of its rule, in words."""
        least, most = (self.rule.get(key) for key in ("at_least", "at_most"))
        return " and ".join(part for part in (
            f"at least {least:g}" if least is not None else "",
            f"at most {most:g}" if most is not None else "") if part)


def toml_reader():
    try:
        import tomllib  # pylint: disable=import-outside-toplevel
    except ModuleNotFoundError:  # Python 3.10
        try:
            import tomli as tomllib  # pylint: disable=import-outside-toplevel
        except ModuleNotFoundError as error:
            raise ClaimError("Python 3.10 reads TOML with tomli alone: pip install -r "
                             "scripts/requirements.txt") from error
    return tomllib


def fits(value, kind):
    if kind == COLUMNS:
        return isinstance(value, dict) and all(isinstance(one, str) for one in value.values())
    if kind == SELECTION:
        return isinstance(value, dict) and all(
            isinstance(one, str) or isinstance(one, list) and one
            and all(isinstance(each, str) for each in one) for one in value.values())
    if kind == NUMBER:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, {TEXT: str, TRUTH: bool}[kind])


def check_keys(found, kinds, needed, place):
    for key, value in found.items():
        if key not in kinds:
            raise ClaimError(f"{place}{key}: unknown key; expected one of {', '.join(kinds)}")
        if not fits(value, kinds[key]):
            raise ClaimError(f"{place}{key}: expected {kinds[key]}")
    for key in needed:
        if key not in found or found[key] == "" and key != "number":
            raise ClaimError(f"{place}{key}: missing")


def check_rule(rule, place):
    check_keys(rule, KEYS, NEEDED, place)
    statistic = rule.setdefault("statistic", "ratio")
    if statistic not in STATISTICS:
        raise ClaimError(f"{place}statistic: expected one of {', '.join(STATISTICS)}")
    needed = {"ratio": ["numerator", "denominator"], "steps": ["along"], "exponent": ["along"]}
    for key in needed.get(statistic, []):
        if key not in rule:
            raise ClaimError(f"{place}{key}: missing; a rule on {statistic} needs it")
    if "at_least" not in rule and "at_most" not in rule:
        raise ClaimError(f"{place}at_least: missing; a rule needs it or at_most")
    if ("assumed_spread" in rule) != ("assumed_because" in rule):
        raise ClaimError(f"{place}assumed_because: goes with assumed_spread")


def read_claim(path):
    path = Path(path)
    try:
        found = toml_reader().loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise error if isinstance(error, ClaimError) else ClaimError(
            f"{path.name}: not TOML: {error}") from error
    rule, lacks = found.pop("rule", None), found.pop("lacks", None)
    for key, part in (("rule", rule), ("lacks", lacks)):
        if part is not None and not isinstance(part, dict):
            raise ClaimError(f"{path.name}: {key}: expected a table")
    check_keys(found, OF_CLAIM, OF_CLAIM, f"{path.name}: ")
    if (rule is None) == (lacks is None):
        raise ClaimError(f"{path.name}: rule: a claim has either a rule or says what ptexp [lacks]")
    if rule is not None:
        check_rule(rule, f"{path.name}: rule.")
    else:
        check_keys(lacks, OF_LACKS, OF_LACKS, f"{path.name}: lacks.")
    return Claim(path.stem, **found, rule=rule or {}, lacks=lacks or {})


def read_claims(folder=CLAIMS):
    """All claims, by the names of their files."""
    return [read_claim(path) for path in sorted(Path(folder).glob("*.toml"))]
