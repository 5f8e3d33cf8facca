"""Reads and checks submissions: files of results/submissions, in which others send what a tier of
scripts/reproduce measured on their device (lib/submissions.py makes them). SCHEMA has all keys;
anything else is an error that names file and key, as is a text that may name a path or a host.
"""
import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from lib.claim_files import read_claims
from lib.program import ROOT

sys.path.insert(0, str(ROOT / "scripts"))
# pylint: disable=wrong-import-position
from report_parts.claims import COLOURS  # noqa: E402
from report_parts.modes import MODES, Work  # noqa: E402
from report_parts.tables import CONFIDENCE, Interval  # noqa: E402
from report_parts.words import change, quotient  # noqa: E402

SUBMISSIONS = ROOT / "results" / "submissions"
VERSION = 1
TIERS = ("minute", "ten", "all")
MOST_BYTES = 1 << 20
MOST_LETTERS = 120
ENDS = ("middle", "low", "high")
TIMES = tuple(f"kernel_ms_{part}" for part in ("median", "low", "high"))
# A path, an address, or letters around a dot, as in a host's name or a file's.
PLACE = re.compile(r"(?i)[\\~]|::|(?:^|\s)/|\w/\w|\w@\w|\b[a-z][\w-]*\.[a-z]"
                   r"|\b\d{1,3}(?:\.\d{1,3}){3}\b|(?:[0-9a-f]{1,4}:){5}")


class SubmissionError(ValueError):
    """A submission is not as it should be, or cannot be made of the tables."""


@dataclass(frozen=True)
class Kind:
    """Of a value."""
    expected: str
    fits: Callable


def is_text(value):
    return isinstance(value, str) and len(value) <= MOST_LETTERS and value.isprintable()


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def text(pattern, expected):
    return Kind(expected, lambda value: is_text(value) and bool(re.fullmatch(pattern, value)))


def one_of(names):
    return Kind(f"one of {', '.join(names)}", lambda value: is_text(value) and value in names)


def whole(low, high):
    return Kind(f"a whole number from {low} to {high}",
                lambda value: is_number(value) and isinstance(value, int) and low <= value <= high)


NAME = text(r"\S.*", f"a text of at most {MOST_LETTERS} letters")
MAYBE = text(r".*", f"a text of at most {MOST_LETTERS} letters, or an empty one")
TIME = Kind("a time in ms, above 0 and below a day",
            lambda value: is_number(value) and 0 < value < 86.4e6)
NUMBER = Kind("a number", lambda value: is_number(value) and abs(value) < 1e15)
END = Kind("a number, or null for both ends", lambda value: value is None or NUMBER.fits(value))
VALUE = {"middle": NUMBER, "low": END, "high": END}
OF_MODE = {**dict.fromkeys(TIMES, TIME), "repeat": whole(1, 100000), "rounds": whole(1, 10000)}
SCHEMA = {
    "schema_version": whole(VERSION, VERSION),
    "tier": one_of(TIERS),
    "date": text(r"20\d\d-[01]\d-[0-3]\d", "a day, YYYY-MM-DD"),
    "program": {
        "version": text(r"\d+(\.\d+){1,2}", "a version such as 0.2.0"),
        "commit": text(r"[0-9a-f]{7,40}", "a commit, 7 to 40 hexadecimal digits, not dirty"),
        "build_type": NAME, "cuda": MAYBE, "fast_math": one_of(("on", "off"))},
    "device": {"name": NAME, "kind": one_of(("cpu", "cuda")), "detail": MAYBE,
               "driver": text(r"[\d.]*", "the driver's version, or an empty text"), "cuda": MAYBE},
    "works": [{
        "scene_hash": text(r"built-in [\w:.-]+|sha256 [0-9a-f]{16}",
                           "'built-in SCENE' or 'sha256' with 16 hexadecimal digits"),
        "width": whole(1, 1 << 20), "height": whole(1, 1 << 20), "spp": whole(1, (1 << 31) - 2),
        "max_depth": whole(0, 1 << 20), "table": NAME, **dict.fromkeys(MODES, OF_MODE)}],
    # `within`: how many of the cases are within the rule's bounds; then the least and the greatest.
    "claims": [{"claim": NAME, "verdict": one_of(tuple(COLOURS)), "table": NAME,
                "cases": whole(1, 10000), "within": whole(0, 10000),
                "least": VALUE, "greatest": VALUE}],
}


def check(value, schema, place):
    """That the value has the kinds of the schema, and no more."""
    if isinstance(schema, Kind):
        if not schema.fits(value):
            raise SubmissionError(f"{place}: expected {schema.expected}")
        if isinstance(value, str) and PLACE.search(value):
            raise SubmissionError(f"{place}: {value!r} may name a path or a host; expected none")
    elif isinstance(schema, list):
        if not isinstance(value, list):
            raise SubmissionError(f"{place}: expected a list")
        for number, one in enumerate(value):
            check(one, schema[0], f"{place}[{number}]")
    else:
        if not isinstance(value, dict):
            raise SubmissionError(f"{place or 'the file'}: expected an object")
        start = f"{place}." if place else ""
        for key in value:
            if key not in schema:
                raise SubmissionError(f"{start}{ascii(key)[1:-1][:40]}: unknown key; expected one of "
                                      f"{', '.join(schema)}")
        for key, kind in schema.items():
            if key not in value:
                raise SubmissionError(f"{start}{key}: missing")
            check(value[key], kind, f"{start}{key}")


def check_interval(found, names, place):
    middle, low, high = (found[name] for name in names)
    if (low is None) != (high is None) or low is not None and not low <= middle <= high:
        raise SubmissionError(f"{place}.{names[0]}: {middle} is outside of its interval "
                              f"[{low}, {high}]")


def check_works(works):
    if not works:
        raise SubmissionError("works: expected one or more")
    seen = set()
    for number, found in enumerate(works):
        place = f"works[{number}]"
        if work_of(found) in seen:
            raise SubmissionError(f"{place}: {work_of(found)} is there twice")
        seen.add(work_of(found))
        for mode in MODES:
            check_interval(found[mode], TIMES, f"{place}.{mode}")
            if found[mode]["rounds"] > found[mode]["repeat"]:
                raise SubmissionError(f"{place}.{mode}.rounds: expected at most as many as repeats")


def check_claims(claims):
    known, seen = {claim.name for claim in read_claims()}, set()
    for number, found in enumerate(claims):
        place, name = f"claims[{number}]", found["claim"]
        if name not in known or name in seen:
            raise SubmissionError(f"{place}.claim: {name!r} is "
                                  f"{'there twice' if name in seen else 'no file of experiments/claims'}")
        seen.add(name)
        for end in ("least", "greatest"):
            check_interval(found[end], ENDS, f"{place}.{end}")
        if found["least"]["middle"] > found["greatest"]["middle"]:
            raise SubmissionError(f"{place}.least.middle: expected at most greatest.middle")
        within, cases = found["within"], found["cases"]
        if not {"reproduced": within == cases, "holds only when": 0 < within < cases}.get(
                found["verdict"], within == 0):
            raise SubmissionError(f"{place}.verdict: {found['verdict']!r} does not go with {within} of "
                                  f"{cases} cases within the bounds")


def check_submission(facts):
    """Raises SubmissionError with the first key that is wrong."""
    version = facts.get("schema_version") if isinstance(facts, dict) else VERSION
    if is_number(version) and version != VERSION:
        raise SubmissionError(f"schema_version: {version}; expected {VERSION}")
    check(facts, SCHEMA, "")
    check_works(facts["works"])
    check_claims(facts["claims"])


def work_of(found):
    """A file's scene is called by its hash."""
    return Work(found["scene_hash"].removeprefix("built-in "), *(found[name] for name in (
        "width", "height", "spp", "max_depth")))


@dataclass
class Submission:
    name: str  # of the file
    facts: dict

    @property
    def device(self):
        return self.facts["device"]["name"]

    @property
    def commit(self):
        return self.facts["program"]["commit"][:7]

    def times(self):
        """{work: (megakernel's, wavefront's)}"""
        return {work_of(found): tuple(
            Interval(*(found[mode][name] for name in TIMES), CONFIDENCE) for mode in MODES)
                for found in self.facts["works"]}

    def ratios(self):
        """{work: (the megakernel's time over the wavefront's, what the wavefront is)}"""
        return {work: (quotient(*pair), change(*pair)[0]) for work, pair in self.times().items()}

    def claims(self):
        """{claim: what the file says of it}"""
        return {found["claim"]: found for found in self.facts["claims"]}


def no_constant(name):
    raise ValueError(f"{name} is no number")


def without_repetition(pairs):
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key is there twice")
    return found


def read_submission(path):
    """Raises SubmissionError that names file and key."""
    path = Path(path)
    try:
        with open(path, encoding="utf-8") as file:
            content = file.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise SubmissionError(f"{path}: larger than {MOST_BYTES >> 20} MiB")
        facts = json.loads(content, parse_constant=no_constant, object_pairs_hook=without_repetition)
        check_submission(facts)
    except OSError as error:
        raise SubmissionError(f"{path}: {error.strerror}") from error
    except SubmissionError as error:
        raise SubmissionError(f"{path}: {str(error).removeprefix(f'{path}: ')}") from error
    except (ValueError, RecursionError) as error:
        raise SubmissionError(f"{path}: not JSON in UTF-8: {error}") from error
    return Submission(path.stem, facts)


def read_submissions(folder=SUBMISSIONS):
    """Those of a folder, by the names of their files; of none where there is no folder."""
    return [read_submission(path) for path in sorted(Path(folder).glob("*.json"))]


def column_names(submissions):
    """The device of each; where two have one device, commit and tier as well."""
    devices = [one.device for one in submissions]
    return [one.device if devices.count(one.device) == 1 else
            f"{one.device} ({one.commit}, {one.facts['tier']})" for one in submissions]
