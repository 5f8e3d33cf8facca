"""What an experiment is made of: its configurations, its picture, what it does with the rows."""
from dataclasses import dataclass, field
from typing import Callable


class HarnessError(Exception):
    """Ends the experiment; its text is one line for the user."""


class Refused(HarnessError):
    """ptexp took offence at an option, or at what the option needs."""


@dataclass
class Device:
    choice: str  # as --device takes it
    name: str
    detail: str
    gpus: int = 1  # of the machine
    calibration: str = "none"  # as --calibration takes it

    @property
    def kind(self):
        return self.choice.partition(":")[0]


@dataclass
class Configuration:
    name: str  # unique in its experiment
    arguments: str  # of ptexp; the harness adds device, repeats and files
    labels: dict = field(default_factory=dict)  # columns of the experiment's own
    device: str = ""  # "": the experiment's device
    repeat: int = 0  # 0: as the command line says; then warmup is the command line's too
    warmup: int = 0
    image: str = ""  # a whole path is kept, for `finish`; else a name, thrown away ["image.ppm"]
    same_image: str = ""  # all with one such name render equal images, bit for bit; "": unchecked
    program: str = ""  # "": the experiment's ptexp
    launcher: str = ""  # a command before it: "mpirun -n 4", "env NAME=VALUE"
    renders: bool = True  # else a command that is timed as it is: the harness adds no option
    way: str = ""  # resident.ONE or EACH; "": as all of the table
    prepare: Callable = None  # called before each of its processes, outside of their times


@dataclass
class Plot:
    """How plot.py draws the table. Rows with one label `panel` share axes; in `lines`, rows with
    one label `series` share a line, in `points` a marker, beside the diagonal; the label `x` is the place on the axis, a number for lines, and
    nothing for a row that the picture leaves out. A bar of `stack` has a segment for each of the
    `parts` that its row has."""
    kind: str  # "lines", "points", "bars" or "stack"
    title: str
    x_label: str = ""  # "": each panel's axis has the panel's name
    y_label: str = "kernel time [ms]"
    y: str = "kernel_ms"  # the columns y_median, then y_low, y_high or else y_min, y_max
    log_y: bool = True
    mark: float = None  # a value of y that a line marks
    parts: tuple = ()  # of `stack`: (column, name), in order


def no_arguments(_parser):
    """For experiments without options of their own."""


def no_columns(_rows, _arguments):
    """For experiments whose labels are known before the measurement."""


def no_conclusions(_rows, _arguments):
    """For experiments whose table says it all."""
    return []


@dataclass
class Experiment:
    name: str
    question: str
    configurations: Callable  # (arguments, device) -> list of Configuration; None: see main()
    plot: Plot  # None: a table without a picture
    add_arguments: Callable = no_arguments
    finish: Callable = no_columns  # fills in labels of measured rows: (rows, arguments)
    table: tuple = ()  # labels to print besides name and time
    conclude: Callable = no_conclusions  # sentences for below the table: (rows, arguments)
    # Options of the images that are compared before the measurement, instead of the configuration's
    # own. More paths than --finish-paths, or no image would come from the wavefront's stages.
    image_check: str = "--width 256 --height 256 --spp 8"
    quick_image_check: str = "--width 24 --height 12 --spp 2"
    needs_gpu: bool = False  # on a CPU it says so in one line and measures nothing
    whole_process: bool = False  # the table says where the wall time of each process went
