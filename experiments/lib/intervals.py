"""Medians of few measurements, and how sure they are: as the Python package says."""
import sys
from statistics import median  # noqa: F401

from lib.program import ROOT

sys.path.insert(0, str(ROOT / "scripts"))
from report_parts.shared import intervals  # noqa: E402 pylint: disable=wrong-import-position

RESAMPLES = intervals.RESAMPLES
bootstrap, ends, median_interval = intervals.bootstrap, intervals.ends, intervals.median_interval
interval_of_ratio, in_rounds, shares = intervals.interval_of_ratio, intervals.in_rounds, intervals.shares
