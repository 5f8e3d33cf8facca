"""Measuring renders: variants in turns in one process, medians with intervals."""
from itertools import chain, product
from statistics import median
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

from ._errors import Error, OptionError
from ._intervals import change, interval_of_ratio, median_interval, shares
from ._options import OF_MEASURE, check_of_measure, show_keywords, split_loading, takes_one_value
from ._progress import Progress, shown
from ._scene import PathLike, Scene, load, render
from ._table import Table, interval_of, interval_text, rounds_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import MeasureOptions, Mode, SweepOptions

MODES = ("megakernel", "wavefront")


class _Variant:
    """One way to render, and what was measured of it."""

    def __init__(self, labels: Dict[str, Any], options: Dict[str, Any]) -> None:
        self.labels, self.options = labels, options
        self.rounds: List[List[Dict[str, Any]]] = []  # of each round the `runs` of its statistics
        self.statistics: Dict[str, Any] = {}  # of the last one

    def measure(self, scene: Scene, repeat: int, warmup: int) -> None:
        # None: not what the scene was loaded with, such as files
        image = render(scene, **{**dict.fromkeys(OF_MEASURE), **self.options, "repeat": repeat, "warmup": warmup})
        self.statistics = image.stats
        self.rounds.append(image.stats["runs"])

    def rows(self, by_stage: bool) -> List[Dict[str, Any]]:
        if not self.rounds:
            return []
        whole = self.row({"stage": "all"} if by_stage else {},
                         [[run["kernel_ms"] for run in runs] for runs in self.rounds])
        if not by_stage:
            return [whole]
        times = [[{stage["stage"]: stage["time_ms"] for stage in run["stages"]} for run in runs]
                 for runs in self.rounds]
        names = dict.fromkeys(name for run in chain(*times) for name in run)
        parts = [self.row({"stage": name}, [[run.get(name, 0.0) for run in runs] for runs in times]) for name in names]
        return [whole, *({**part, "mrays_per_s": None} for part in parts)]

    def row(self, stage: Dict[str, str], rounds_ms: List[List[float]]) -> Dict[str, Any]:
        times = list(chain(*rounds_ms))
        low, high = median_interval(tuple(map(tuple, rounds_ms))) if len(times) > 1 else (None, None)
        counts = {name: self.statistics["counts"][name] for name in ("paths", "rays", "shadow_rays")}
        rate = (counts["rays"] + counts["shadow_rays"]) / (1000 * median(times)) if median(times) else None
        return {**self.labels, **stage, "time_ms": median(times), "low_ms": low, "high_ms": high, "min_ms": min(times),
                "max_ms": max(times), "mrays_per_s": rate, **counts, "repeat": len(times), "rounds_ms": rounds_ms,
                "device": self.statistics["device"]["name"]}


def measure(
    scene: Union[Scene, PathLike],
    *,
    modes: "Union[Mode, Sequence[Mode]]" = MODES,
    repeat: int = 10,
    warmup: int = 1,
    rounds: int = 3,
    by_stage: bool = False,
    progress: Progress = None,
    **options: "Unpack[MeasureOptions]",
) -> Table:
    """Measures how long a scene renders in each mode.

    Modes take their turns in this process: in each round every mode renders, first to warm up and
    then its share of the repeats; every second round goes backwards. So a machine that drifts hits
    all alike. Times are the program's: those of kernels on CUDA, wall times on the CPU.

    Args:
        scene: a :class:`Scene`, or what :func:`load` takes.
        modes: "megakernel", "wavefront", "serial" or "auto"; one or a list.
        repeat: measured renders of each mode, in all rounds together, at least 1.
        warmup: renders before them in each round, which are not measured.
        rounds: how often all take their turn, at least 1.
        by_stage: adds a row for each stage.
        progress: as of :func:`render`; counts renders.
        **options: those of :func:`render` for all modes, but no files.

    Returns:
        The table, with a row for each mode.

    Raises:
        OptionError, Error, KeyboardInterrupt: as :func:`render`. What is raised after the first
            measured render has the table so far as its attribute ``table``.
    """
    return _measured(scene, modes, repeat, warmup, rounds, by_stage, progress, options, is_sweep=False)


def sweep(
    scene: Union[Scene, PathLike],
    *,
    modes: "Union[Mode, Sequence[Mode]]" = MODES,
    repeat: int = 10,
    warmup: int = 1,
    rounds: int = 3,
    by_stage: bool = False,
    progress: Progress = None,
    **options: "Unpack[SweepOptions]",
) -> Table:
    """Measures a scene with several values of options: ``sweep(scene, max_depth=[2, 4, 8], spp=[1, 16])``.

    Args:
        **options: each a value or a list of values; all combinations are measured. Tuples and arrays
            are lists of values, too, but those of options that take several numbers or words
            (``look_from``) are one value. The others: as of :func:`measure`.

    Returns:
        The table, with a row for each combination and mode.

    Raises:
        OptionError, Error, KeyboardInterrupt: as :func:`measure`, also if a mode lacks an option.
    """
    return _measured(scene, modes, repeat, warmup, rounds, by_stage, progress, options, is_sweep=True)


def _values(keyword: str, value: Any) -> Optional[List[Any]]:
    """The values of an option that is swept; None: it has one."""
    if isinstance(value, (list, range)):
        return list(value)
    if takes_one_value(keyword) and (isinstance(value, tuple) or getattr(value, "ndim", 0) == 1):
        return value.tolist() if hasattr(value, "tolist") else list(value)
    return None


def _variants(modes: Iterable[str], options: Dict[str, Any], is_sweep: bool) -> Tuple[Tuple[str, ...], List[_Variant]]:
    """(labels, variants)"""
    swept = {}
    for keyword, value in options.items() if is_sweep else ():
        values = _values(keyword, value)
        if values is not None:
            swept[keyword] = values
    fixed = {keyword: value for keyword, value in options.items() if keyword not in swept}
    variants = [_Variant({**dict(zip(swept, values)), "mode": mode}, {**fixed, **dict(zip(swept, values)), "mode": mode})
                for values in product(*swept.values()) for mode in modes]
    return (*swept, "mode"), variants


def _check_counts(repeat: int, warmup: int, rounds: int) -> None:
    for name, value, least in (("repeat", repeat, 1), ("warmup", warmup, 0), ("rounds", rounds, 1)):
        if not isinstance(value, int) or value < least:
            raise OptionError(f"--{name} {value}: expected an integer of {least} or more")


def _measured(scene: Union[Scene, PathLike], modes: Union[str, Sequence[str]], repeat: int, warmup: int, rounds: int,
              by_stage: bool, progress: Progress, options: Any, *, is_sweep: bool) -> Table:
    check_of_measure(options)
    _check_counts(repeat, warmup, rounds)
    modes = (modes,) if isinstance(modes, str) else tuple(modes)
    if not isinstance(scene, Scene):
        loading, options = split_loading(options)
        scene = load(scene, **loading)
    labels, variants = _variants(modes, options, is_sweep)
    if not variants:
        raise OptionError("--mode: nothing to measure; expected a mode, and a value of each swept option")
    try:
        _take_turns(scene, variants, shares(repeat, rounds), warmup, progress)
    except BaseException as error:
        rows = [row for variant in variants for row in variant.rows(by_stage)]
        if rows:
            error.table = Table(rows, labels)  # type: ignore[attr-defined]
        raise
    return Table((row for variant in variants for row in variant.rows(by_stage)), labels)


def _take_turns(scene: Scene, variants: List[_Variant], of_rounds: List[int], warmup: int, progress: Progress) -> None:
    """All variants in each round, every second round backwards."""
    turns = [(variant, repeat) for number, repeat in enumerate(of_rounds) if repeat
             for variant in variants[:: -1 if number % 2 else 1]]
    done, total = 0, sum(repeat + warmup for _, repeat in turns)
    with shown(progress, "renders") as tell:
        for variant, repeat in turns:
            variant.measure(scene, repeat, warmup)
            done += repeat + warmup
            if tell:
                tell(done, total)


class ModeComparison(NamedTuple):
    """Which mode is faster, and how sure that is."""

    ratio: float  #: the megakernel's median time over the wavefront's: above 1 the wavefront is faster
    low: Optional[float]  #: 95 % interval of the ratio, by bootstrap; None of a single repeat
    high: Optional[float]
    word: str  #: of the wavefront: "faster" or "slower" where the intervals of both times are apart;
    #: "same" where they overlap and the medians are within 2 %; else "ambiguous"
    table: Table  #: what was measured

    @property
    def faster(self) -> Optional[str]:
        """The mode that is faster for sure, for ``mode=``; None: neither."""
        return {"faster": "wavefront", "slower": "megakernel"}.get(self.word)

    def __str__(self) -> str:
        interval = interval_text(self.low, self.high)
        return f"wavefront: {self.ratio:.3g} times as fast as the megakernel {interval}".rstrip() + f": {self.word}"

    def __repr__(self) -> str:
        return str(self)


def compare_modes(
    scene: Union[Scene, PathLike],
    *,
    repeat: int = 10,
    warmup: int = 1,
    rounds: int = 3,
    progress: Progress = None,
    **options: "Unpack[MeasureOptions]",
) -> ModeComparison:
    """Measures megakernel and wavefront in turns: ``print(ptexp.compare_modes("cornell"))``.

    Args:
        scene, repeat, warmup, rounds, progress, **options: as of :func:`measure`.

    Returns:
        The ratio of the medians with its interval, and a word, by the definitions of the experiments.

    Raises:
        OptionError, Error, KeyboardInterrupt: as :func:`measure`.
        Error: the modes traced different numbers of rays, as ``time_limit`` may make them.
    """
    table = measure(scene, modes=MODES, repeat=repeat, warmup=warmup, rounds=rounds, progress=progress, **options)
    return compared(table)


def compared(table: Table) -> ModeComparison:
    """Of a table with a row for each of both modes."""
    megakernel, wavefront = table
    for count in ("paths", "rays", "shadow_rays"):
        if megakernel[count] != wavefront[count]:
            raise Error(f"the megakernel traced {megakernel[count]} {count}, the wavefront {wavefront[count]}; "
                        "times are compared of equal work alone")
    word, _ = change(interval_of(megakernel), interval_of(wavefront))
    is_known = megakernel["repeat"] > 1
    low, high = interval_of_ratio(rounds_of(megakernel), rounds_of(wavefront)) if is_known else (None, None)
    return ModeComparison(megakernel["time_ms"] / wavefront["time_ms"], low, high, word, table)


for _function in (measure, sweep, compare_modes):
    show_keywords(_function, "measure")
