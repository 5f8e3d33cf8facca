"""Which way to render a scene is the fastest: what `ptexp advise` measures, as an object."""
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Tuple, Union

from . import _ptexp
from ._errors import Error, OptionError
from ._options import OF_ONE_RENDER, check_of_render, show_keywords, split_loading, to_words
from ._scene import PathLike, Scene, load

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import LoadOptions

_OWN = OF_ONE_RENDER | {"exposure", "target_error", "quiet"}


class AdvisedWay(NamedTuple):
    """A way to render, measured in turns with the default."""

    options: Dict[str, str]  #: keywords of :func:`render` beside those that were given; none: the default
    mode: str
    total_ms: float  #: of all samples that are wanted, with the building of the tree
    times_as_fast: Tuple[float, float, float]  #: as the default: median, and its 95 % interval
    word: str  #: "faster", "slower", "same" or "ambiguous"
    stages_ms: Dict[str, float]  #: of its last render


class Advice(NamedTuple):
    """What :func:`advise` returns; prints as `ptexp advise` does."""

    best: AdvisedWay  #: the way to take: faster for sure and by more than 2 %, else the default
    default: AdvisedWay
    ways: List[AdvisedWay]  #: the others that took turns, the fastest first
    text: str
    device: str
    tried: int  #: ways in all
    rounds: int
    samples: int  #: per pixel, that were rendered for a time
    scale: float  #: of the image's width and height, in (0, 1]
    seconds: float

    @property
    def options(self) -> Dict[str, str]:
        """The best way: ``ptexp.render(scene, **advice.options)``."""
        return self.best.options

    def __str__(self) -> str:
        return self.text.rstrip("\n")

    def __repr__(self) -> str:
        return str(self)


def advise(scene: Union[Scene, PathLike], *, time_limit: float = 60, **options: "Unpack[LoadOptions]") -> Advice:
    """Measures which way to render a scene is the fastest here: ``print(ptexp.advise("cornell"))``.

    Both modes and the options that matter are tried, the fastest of them in turns.

    Args:
        scene: a :class:`Scene`, or what :func:`load` takes.
        time_limit: seconds, above 0, for all of it.
        **options: those of :func:`render`; what is given is not changed. No files, no repeats.

    Returns:
        The :class:`Advice`.

    Raises:
        OptionError, Error: as :func:`render`, also if nothing was rendered within the time.
        KeyboardInterrupt: after Ctrl-C.
    """
    for keyword in options:
        if keyword in _OWN:
            raise OptionError(f"--{keyword.replace('_', '-')}: has no effect together with advise")
    if isinstance(time_limit, bool) or not isinstance(time_limit, (int, float)) or not time_limit > 0:
        raise OptionError(f"--time-limit {time_limit}: expected seconds above 0")
    if not isinstance(scene, Scene):
        loading, options = split_loading(options)  # type: ignore[assignment]
        scene = load(scene, **loading)
    check_of_render(options)
    given: Dict[str, Any] = {key: value for key, value in {**scene._options, **options}.items()
                             if key not in _OWN | {"time_limit"}}
    found, raised = scene._native.advise(to_words(given), float(time_limit))
    if raised is not None:
        raise raised
    if found is None:
        raise Error(f"time_limit={time_limit:g}: no render ended before; expected more seconds")
    way = {key: AdvisedWay(**found.pop(key)) for key in ("best", "default")}
    return Advice(ways=[AdvisedWay(**one) for one in found.pop("ways")], **way, **found)


show_keywords(advise, "load")


class Calibration(NamedTuple):
    """What :func:`calibrate` returns; prints as `ptexp calibrate` does."""

    file: str  #: in the user's cache folder, which later renders read
    constants: Dict[str, float]  #: by name, those that were measured
    kept: List[str]  #: why others keep the values of an H200
    text: str
    seconds: float

    def __str__(self) -> str:
        return self.text.rstrip("\n")


def calibrate(*, device: str = "auto", threads: int = 0, sms: int = 0) -> Calibration:
    """Measures in at most 30 s the numbers by which auto decides on a device, and stores them.

    Args:
        device: as for :func:`render`, one device.
        threads: of the CPU; 0: one per core.
        sms: multiprocessors of a GPU to use; 0: all.

    Returns:
        The :class:`Calibration`.

    Raises:
        OptionError, Error: for a device that is not there, or a folder that cannot be written to.
        KeyboardInterrupt: after Ctrl-C.
    """
    given: Dict[str, Any] = {"device": device}
    given.update({name: value for name, value in (("threads", threads), ("sms", sms)) if value})
    found, raised = _ptexp.calibrate(to_words(given))
    if raised is not None:
        raise raised
    return Calibration(**found)
