#!/usr/bin/env python3
"""Draws the tables of the experiments: NAME.csv, with the NAME.json beside it, as NAME.png."""
import argparse
import sys
from pathlib import Path

try:
    from lib.plot import draw
except ImportError as missing:
    sys.exit(f"plot.py: error: {missing}; experiments/README.md says how to install matplotlib")
from lib.table import read_facts


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", metavar="NAME.csv", nargs="+", type=Path)
    for path in parser.parse_args().tables:
        try:
            if "plot" in read_facts(path):
                print(f"wrote {draw(path)}")
            else:
                print(f"{path}: a table without a picture")
        except (OSError, ValueError, KeyError) as error:
            sys.exit(f"plot.py: error: {path}: {error}")


if __name__ == "__main__":
    main()
