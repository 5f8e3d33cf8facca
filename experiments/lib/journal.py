"""What has been measured so far: NAME.journal beside the table, a line of JSON for each event.

A line is written when its event is over. A harness that is cut off, in the middle of a line even,
loses no other, and the next one with the same key goes on from there.
"""
import contextlib
import json
import os
from dataclasses import asdict, fields

from lib.program import Process
from lib.table import write_atomically


def read_events(path):
    """Those up to a line that was cut off: an object without its end is no JSON."""
    events = []
    with contextlib.suppress(FileNotFoundError, ValueError):
        for line in path.read_text(encoding="utf-8").splitlines():
            events.append(json.loads(line))
    return events


class Journal:
    def __init__(self, path, key, fresh, keeps):
        """Goes on with the file at `path` if it has the key and not `fresh`, but leaves out the
        processes of the names that `keeps` does not accept, and of those that failed: they are
        measured once more."""
        self.path, self.key, self.events, self.by_name = path, key, [], {}
        events = read_events(path)
        if fresh or not events or events[0].get("key") != key:
            return
        failed = {event["name"] for event in events if event.get("status") == "failed"}
        for event in events:
            name = event.get("name")
            if event["event"] != "process" or name not in failed and keeps(name):
                self.remember(event)

    def remember(self, event):
        self.events.append(event)
        if event["event"] == "process":
            self.by_name.setdefault(event["name"], []).append(
                Process(**{part.name: event[part.name] for part in fields(Process)
                           if part.name in event}))

    def begin(self, **facts):
        """Of this call: the file has whole lines alone from now on."""
        self.remember({"event": "begin", "key": self.key, **facts})
        write_atomically(self.path, "".join(json.dumps(event) + "\n" for event in self.events))

    def add(self, event, **facts):
        self.remember({"event": event, **facts})
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(self.events[-1]) + "\n")
            file.flush()
            os.fsync(file.fileno())

    def add_process(self, name, number, process):
        self.add("process", name=name, round=number, **asdict(process))

    def of(self, event):
        """The facts of all events of a kind, in order."""
        return [{key: value for key, value in one.items() if key != "event"}
                for one in self.events if one["event"] == event]

    def measure_groups(self, kind, groups, save):
        """All rows of groups of rows, `groups` being (name, function that measures the rows) in
        order. Those that the journal has, none of which failed, are not measured again; `save` is
        called with the rows so far after every group."""
        known = {event["name"]: event["rows"] for event in self.of(kind)
                 if all(row["status"] != "failed" for row in event["rows"])}
        rows = []
        for name, measure in groups:
            if name not in known:
                known[name] = measure()
                self.add(kind, name=name, rows=known[name])
                print(name, flush=True)
            rows += known[name]
            save(rows)
        return rows

    def processes(self, name):
        """Those that measured a configuration, in order."""
        return self.by_name.get(name, [])

    def remove(self):
        self.path.unlink(missing_ok=True)
