"""One call of an experiment: what it measures, and what its table may be joined with."""
import argparse
import hashlib
import json
import shlex
from dataclasses import asdict, dataclass, field
from pathlib import Path

from lib.description import Device, Experiment
from lib.program import version_of
from lib.provenance import provenance, scene_hash
from lib.resident import EACH
from lib.rounds import command_line
from lib.table import read_facts


@dataclass
class Session:
    experiment: Experiment
    arguments: argparse.Namespace
    program: Path
    device: Device
    configurations: list
    path: Path = None  # of the table
    key: str = ""  # as key_of() says
    way: str = EACH  # as way_of() says
    pooled: dict = field(default_factory=dict)  # rows that rounds.py has made already


def key_of(session, given):
    """Equal for calls whose measurements may stand in one table."""
    programs = {str(session.program), *(c.program for c in session.configurations if c.program)}
    where = ("ptexp", "output", "timeout", "list", "fresh")
    facts = {
        "programs": sorted(map(version_of, programs)),
        "device": asdict(session.device),
        "arguments": {name: str(value) for name, value in given.items() if name not in where},
        "configurations": {c.name: [c.arguments, c.labels, c.device, c.repeat, c.warmup, c.launcher,
                                    scene_hash(c.arguments)] for c in session.configurations}}
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:16]


def constant_origin(session):
    """Of the table's provenance what no measurement changes, with all command lines: enough to
    measure it again."""
    return {
        **provenance(session.experiment, session.program, session.device, session.arguments),
        "measured_by": " and ".join(sorted({c.way or session.way for c in session.configurations})),
        "configurations": {
            c.name: shlex.join([*launcher, "ptexp", *command_line(session, c)[len(launcher) + 1:]])
            for c in session.configurations for launcher in [shlex.split(c.launcher)]},
    }


def origin(session, journal, constant):
    """The table's provenance."""
    begins = journal.of("begin")
    return {
        **constant, "date": begins[0]["date"], "resumed": [begin["date"] for begin in begins[1:]],
        "key": journal.key, "complete": False, "rounds": journal.of("machine"),
        "equal_images": {event["group"]: event["configurations"]
                         for event in journal.of("equal images")},
        **({"plot": asdict(session.experiment.plot)} if session.experiment.plot else {}),
    }


def is_complete(path, key):
    """Whether the table at `path` has all that a call with this key would measure."""
    try:
        facts = read_facts(path)
        return path.is_file() and facts.get("complete") is True and facts.get("key") == key
    except (OSError, ValueError):
        return False
