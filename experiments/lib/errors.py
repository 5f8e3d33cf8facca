"""Errors of an experiment's images against references that took much longer."""
import re
import shlex
import shutil
from concurrent.futures import ThreadPoolExecutor

from lib import program as ptexp

REFERENCE_SEED = 1000003  # other noise than that of the images
MEASURES = {"rmse": "RMSE", "relmse": "relMSE", "flip": "(?:HDR-)?FLIP"}  # as `compare` prints them


class KeptImages:
    """The images of an experiment's configurations, kept until the end, so that one that was cut
    off goes on."""

    def __init__(self, name, arguments):
        self.folder = arguments.output.resolve() / f".{name}-images{arguments.label}"
        self.paths = {}
        if not arguments.list:
            self.folder.mkdir(parents=True, exist_ok=True)

    def add(self, name):
        """A path for the image of the configuration of this name."""
        return self.paths.setdefault(name, str(self.folder / f"{len(self.paths)}.exr"))

    def put_errors(self, rows, program, device, options, seconds):
        """The label `relmse` of rows whose images converge to what ptexp's `options` render."""
        reference = str(self.folder / "reference.exr")
        ptexp.run_ptexp(program, *shlex.split(options), "--time-limit", f"{seconds:g}", "--seed",
                        str(REFERENCE_SEED), "--device", device, "--quiet", "--output", reference)
        with ThreadPoolExecutor() as pool:  # `compare` is slow, and one thread
            errors = pool.map(lambda row: relmse(program, self.paths[row["name"]], reference), rows)
            for row, error in zip(rows, errors):
                row["relmse"] = f"{error:.6g}"

    def remove(self):
        shutil.rmtree(self.folder)


def errors(program, image, reference):
    """{name: error} of all MEASURES."""
    text = ptexp.run_ptexp(program, "compare", image, reference)
    return {name: float(re.search(rf"(?m)^{printed}\s+(\S+)$", text).group(1))
            for name, printed in MEASURES.items()}


def relmse(program, image, reference):
    return errors(program, image, reference)["relmse"]
