"""The command line that all experiments share."""
import argparse
import re
from pathlib import Path

from lib.program import PROGRAMS, ROOT


def add_image_options(parser, spp=16):
    """--size and --spp of an experiment whose images are all alike."""
    parser.add_argument("--size", type=int, default=1024, metavar="N",
                        help="width and height in pixels [%(default)s]")
    parser.add_argument("--spp", type=int, default=spp, metavar="N",
                        help="samples per pixel [%(default)s]")


def parse_arguments(experiment, command):
    parser = argparse.ArgumentParser(description=experiment.question)
    add = parser.add_argument
    add("--ptexp", metavar="FILE", default="",
        help=f"the program [$PTEXP, else {' or '.join(PROGRAMS)}]")
    add("--device", metavar="auto|cpu|cuda[:N]", default="auto",
        help="auto: the first GPU if there is one, else the CPU [%(default)s]")
    add("--repeat", metavar="N", type=int, default=10,
        help="measured renders of a configuration, in all rounds together [%(default)s]")
    add("--warmup", metavar="N", type=int, default=3,
        help="renders before them, in each round [%(default)s]")
    add("--rounds", metavar="N", type=int, default=3,
        help="how often all configurations take their turn [%(default)s]")
    add("--fresh", action="store_true",
        help="measure everything, also what the same command has measured before")
    add("--quick", action="store_true",
        help="small images, to see that everything works; labelled 'quick' unless --label is given")
    add("--label", metavar="TEXT", default="",
        help="appended to the files' names, e.g. fast-math for a program built so")
    add("--output", metavar="DIR", type=Path, default=ROOT / "results",
        help="the files are DIR/DEVICE/NAME.csv, .json and .png [results/ of the repository]")
    add("--timeout", metavar="S", type=float, default=3600,
        help="seconds for one configuration in one round [%(default)s]")
    add("--single-processes", action="store_true",
        help="start a process of ptexp for each configuration, where else one measures all")
    add("--calibration", metavar="none|auto|FILE", default="none",
        help="of ptexp's plans, as its --calibration takes it [%(default)s]")
    add("--list", action="store_true", help="print the command lines and run nothing")
    experiment.add_arguments(parser)
    arguments = parser.parse_args(command)
    if min(arguments.repeat, arguments.rounds) < 1 or arguments.warmup < 0:
        parser.error("expected --repeat and --rounds of 1 or more and --warmup of 0 or more")
    if not re.fullmatch(r"[\w.-]*", arguments.label):
        parser.error(f"--label {arguments.label}: expected letters, digits and any of _ . -")
    if arguments.quick and not arguments.label:
        arguments.label = "quick"
    if getattr(arguments, "only", None) and not arguments.label:  # beside the table of all scenes
        arguments.label = "only"
    return arguments
