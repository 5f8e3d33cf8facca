"""Mitsuba 3, with which some tests compare: `mi` and numpy's `np`, both None without the packages
of tests/requirements.txt. Then the tests skip, unless PTEXP_NEEDS_MITSUBA is set."""
import os

try:
    import mitsuba as mi
    import numpy as np
    mi.set_variant("scalar_rgb")
except ImportError:
    if os.environ.get("PTEXP_NEEDS_MITSUBA"):
        raise
    mi = np = None
