"""One process of ptexp, `ptexp measure`, that measures configuration after configuration.

It keeps the device's context, the scene and its tree, which a process for each configuration makes
anew. When it crashes or does not answer, that costs the configuration; another process goes on.
"""
import json
import shlex
import subprocess
import tempfile
import threading
import time
from pathlib import Path

from lib.program import code_text, failed_or_refused, one_line, process_of, words_of

END_S = 10  # after its last word
ONE, EACH = "one process", "a process for each"


def needs_own_process(configuration):
    """Whether only a process of its own measures it: another program, a launcher and its
    environment, or counters, after which CUPTI stays loaded."""
    words = shlex.split(configuration.arguments)
    return bool(configuration.renders and (configuration.program or configuration.launcher
                                           or "--counters" in words))


def way_of(experiment, arguments, configurations):
    """How all of a table is measured, since its rows are compared."""
    if arguments.single_processes or experiment.whole_process:
        return EACH
    return EACH if any(map(needs_own_process, configurations)) else ONE


class Resident:
    """Context manager. The process starts when it is first needed."""

    def __init__(self, program):
        self.program, self.process = program, None
        self.folder = tempfile.TemporaryDirectory(prefix="ptexp-")  # pylint: disable=consider-using-with
        self.errors = Path(self.folder.name, "errors")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()
        self.folder.cleanup()

    def end(self):
        """Kills it: all that it measured has been answered."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def start(self):
        self.end()
        with open(self.errors, "wb") as errors:
            self.process = subprocess.Popen(  # pylint: disable=consider-using-with
                [str(self.program), "measure"], cwd=self.folder.name, stdin=subprocess.PIPE,
                stdout=subprocess.PIPE, stderr=errors, text=True)

    def ask(self, words, timeout_s):
        """(its answer's line, empty if it has ended; whether it was killed after the timeout)"""
        late = threading.Event()

        def end():
            late.set()
            self.process.kill()
        timer = threading.Timer(timeout_s, end)
        timer.start()
        try:
            self.process.stdin.write(json.dumps({"arguments": words}) + "\n")
            self.process.stdin.flush()
            return self.process.stdout.readline(), late.is_set()
        except (BrokenPipeError, UnicodeDecodeError):
            return "", late.is_set()
        finally:
            timer.cancel()

    def lost(self, message):
        """Of a process that is of no use any more."""
        self.end()
        print(f"ptexp measure: {message}; another process goes on", flush=True)
        return failed_or_refused(None, message)

    def measure(self, configuration, device, repeat, warmup, timeout_s):
        """A Process, as program.measure() returns it."""
        words = words_of(self.program, configuration, device, repeat, warmup)
        if Path(configuration.image).is_absolute():
            words += ["--output", configuration.image]
        if self.process is None or self.process.poll() is not None:
            self.start()
        said = self.errors.stat().st_size  # with configurations before this one
        begin_s = time.perf_counter()
        line, is_late = self.ask(words, timeout_s)
        wall_ms = 1e3 * (time.perf_counter() - begin_s)
        if is_late:
            return self.lost(f"no end after {timeout_s:g} s (--timeout)")
        if not line:
            return self.ended(said)
        try:
            answer = json.loads(line)
            if "error" not in answer:
                return process_of(answer["row"], answer["statistics"], wall_ms)
            process = failed_or_refused(answer["exit_code"], one_line(answer["error"]))
        except (ValueError, KeyError, TypeError):
            return self.lost(f"answered {line[:80]!r}; expected statistics or an error as JSON")
        # An error of CUDA may stay with the context.
        return process if process.status == "refused" else self.lost(process.message)

    def ended(self, said):
        try:
            code = self.process.wait(END_S)
        except subprocess.TimeoutExpired:
            return self.lost("closed its output")
        text = self.errors.read_bytes()[said:].decode(errors="replace")
        process = failed_or_refused(code, one_line(text))
        return self.lost(process.message or "ended without an answer")
