"""Statistics that the Python package shares with experiments and report: python/ptexp/_intervals.py.

They are read from there, since `pip install .` takes only that folder. No built module is needed.
"""
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

NAME = "ptexp_intervals"
PATH = Path(__file__).resolve().parents[2] / "python" / "ptexp" / "_intervals.py"

if NAME not in sys.modules:
    spec = spec_from_file_location(NAME, PATH)
    sys.modules[NAME] = module_from_spec(spec)  # where dataclasses look for annotations
    spec.loader.exec_module(sys.modules[NAME])
intervals = sys.modules[NAME]
