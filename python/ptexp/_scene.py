"""Scenes in memory, and rendering them."""
import os
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple, Union

from . import _ptexp
from ._dict import to_elements
from ._errors import Error, checked_text, text_of_path, warn
from ._image import Image
from ._options import as_documentation, check_of_render, show_keywords, to_words
from ._params import Params
from ._progress import Progress, shown

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import LoadOptions, RenderOptions

PathLike = Union[str, "os.PathLike[str]"]


class Scene:
    """A scene in memory, which :func:`load` or :meth:`from_dict` makes.

    It is read once, and prepared (acceleration structure, lights) when a render needs another
    preparation than the one before. One render of a scene at a time: others wait. The scene is kept
    twice, as it was read and as it was prepared.
    """

    def __init__(self, native: "_ptexp.Scene", options: Dict[str, Any]) -> None:
        self._native = native
        self._options = options
        self._params: Optional[Params] = None

    @classmethod
    def from_dict(cls, scene: Dict[str, Any], *, name: str = "dictionary", strict: bool = False,
                  default_lighting: Optional[str] = None, **options: "Unpack[RenderOptions]") -> "Scene":
        """Makes a scene of dictionaries, in the form of Mitsuba 3's ``load_dict``.

        Args:
            scene: ``{"type": "scene", "sensor": {"type": "perspective", "fov": 40, ...}, ...}``:
                what a Mitsuba file can have (docs/scenes.md), by the same names, as
                ``mitsuba.cornell_box()`` returns it. Lists or arrays of three numbers are vectors or
                linear RGB, those of 4x4, 3x4 or 3x3 transforms; arrays and transforms of numpy,
                drjit and Mitsuba's variants are taken. A matrix does not tell the target of a view;
                ``{"type": "lookat", "origin": ..., "target": ..., "up": ...}``, a transform as well,
                keeps it for :attr:`params`. ``{"type": "ref", "id": "red"}`` refers to
                what has the key "red". A "mesh" has ``vertices`` (n, 3), ``triangles`` (m, 3) and
                may have ``normals`` (n, 3) and ``uvs`` (n, 2); a "bitmap" or "envmap" ``data``
                (height, width, 1 to 4), linear floats or sRGB integers, or ``bitmap``, a
                ``mitsuba.Bitmap``; a "gridvolume" ``data`` (z, y, x) or (z, y, x, 1 or 3), or
                ``grid``, a ``mitsuba.VolumeGrid``. Arrays are copied.
            name: for statistics.
            strict: what ptexp lacks is an Error, not a SceneWarning.
            default_lighting: as on the command line.
            **options: those of :func:`render`, for all renders of the scene.

        Raises:
            Error: it is no scene; the message says where: ``scene['box']['bsdf']: ...``.
            ValueError: indices of a mesh are none, or its arrays hold no numbers.
        """
        check_of_render(options)
        words = to_words({**options, "strict": strict, "default_lighting": default_lighting})
        root, arrays = to_elements(scene)
        native = _ptexp.from_elements(root, arrays.meshes, arrays.pictures, arrays.grids, name, words)
        return cls(native, {**options, "scene": name})

    @property
    def name(self) -> str:
        """As statistics call it."""
        return self._native.name

    @property
    def options(self) -> Dict[str, Any]:
        """The keywords that it was loaded with: they hold for all renders that say nothing else."""
        return dict(self._options)

    @property
    def defaults(self) -> Dict[str, int]:
        """What its file asks for: width, height, spp, max_depth, rr."""
        return self._native.defaults()

    @property
    def params(self) -> Params:
        """Camera, materials, lights, instances and vertices, to be changed between renders."""
        if self._params is None:
            self._params = Params(self._native)
        return self._params

    def render(self, *, progress: Progress = None, on_device: bool = False, **options: "Unpack[RenderOptions]") -> Image:
        """:func:`render` of this scene."""
        return render(self, progress=progress, on_device=on_device, **options)

    def __repr__(self) -> str:
        return f"<ptexp.Scene {self.name!r}>"


def load(scene: PathLike, **options: "Unpack[LoadOptions]") -> Scene:
    """Loads a scene.

    Args:
        scene: a file (Mitsuba .xml, .gltf, .glb, .obj, .ply) or the name of a built-in scene, with
            its parameter: ``"spheres"``, ``"terrain:100000"``; see :func:`scenes`.
        **options: those of :func:`render`, for all renders of the scene, and ``define={...}``,
            ``strict=True``, ``time=T``, ``spheres=N``, which say what is read.

    Returns:
        The scene. ``scene.render()`` renders it.

    Raises:
        OptionError: an option is wrong.
        Error: the file is missing or wrong; ``error.file`` and ``error.line`` say where.

    Warns:
        SceneWarning: what the file asks for and ptexp does otherwise (``strict=True``: an Error).
    """
    given = {**options, "scene": text_of_path(scene)}
    return Scene(_ptexp.load(_words(given, given.get("output"))), given)


def load_string(text: str, **options: "Unpack[LoadOptions]") -> Scene:
    """Loads a scene of Mitsuba's XML as a text.

    Args:
        text: ``<scene version="3.0.0">...</scene>``; the files that it names are looked for in the
            current folder.
        **options: as for :func:`load`.

    Raises:
        OptionError: an option is wrong.
        Error: the text is no scene; ``error.line`` says where, ``error.file`` is "<string>".

    Warns:
        SceneWarning: as :func:`load`.
    """
    given = {**options, "scene": "<string>"}
    return Scene(_ptexp.load_text(checked_text(text), _words(given, given.get("output"))), given)


def _words(options: Dict[str, Any], output: Optional[PathLike]) -> List[Tuple[str, str]]:
    """The words of a render. Whether an exposure applies is a matter of the file, or of a later save."""
    if options.get("exposure") is not None:
        options = {**options, "output": "image.png" if output is None else output}
    return to_words(options)


def render(
    scene: Union[Scene, PathLike],
    *,
    progress: Progress = None,
    on_device: bool = False,
    **options: "Unpack[LoadOptions]",
) -> Image:
    """Renders a scene.

    Args:
        scene: a :class:`Scene`, or what :func:`load` takes; a Scene is rendered again without
            being read again.
        progress: True: a bar in terminals and notebooks, by tqdm where that is installed. Or what
            is called with the samples done and wanted, of all pixels, up to 20 times a second, in
            the thread that called; what it raises ends the render and goes on to the caller.
        on_device: a GPU's image stays in its memory, for ``torch.from_dlpack(image)`` and the like
            (see :class:`Image`); the CPU's is in its memory anyway.
        **options: every option of the command line, as listed below. Flags are bools; on/off
            options take bools, too; several values are tuples: ``look_from=(0, 1, 5)``,
            ``crop=(0, 0, 64, 64)``, ``block=(16, 8)``, ``part=(1, 4)``,
            ``aov=("depth", "albedo")``; ``define`` and ``stage_block`` dictionaries. None is as
            good as not given. ``output=`` also writes the image, ``stats=`` and ``csv=`` what they
            do on the command line; ``quiet=False`` prints the table.

    Returns:
        The image: the same bits as the program's.

    Raises:
        OptionError: an option is wrong, or has no effect in this mode or on this device.
        Error: what else the user can mend; also ``on_device`` with several devices, ``checkpoint``
            or ``part``, whose images the host puts together.
        KeyboardInterrupt: Ctrl-C, at once on the CPU and after the batch on a GPU.

    Whatever is raised after a sample was finished (Ctrl-C, by ``progress``, a warning that a filter
    makes an error, a file that cannot be written) has the image of the samples so far as its
    attribute ``image``; the files that can be written are written first, as the program does.

    The interpreter's lock is released meanwhile.
    """
    if not isinstance(scene, Scene):
        return render(load(scene, **options), progress=progress, on_device=on_device)
    check_of_render(options)
    merged = {**scene._options, **options}
    output = merged.pop("output", None)
    quiet = merged.pop("quiet", None)
    if merged.pop("explain", False):
        raise TypeError("render has no use for explain: ptexp.explain(scene, ...) returns the plan")
    words = _words(merged, output)
    if output is not None:
        _ptexp.check_output(text_of_path(output))
    with shown(progress, "samples") as tell:
        native, raised, messages = scene._native.render(words, tell, on_device)
    image = Image(native)
    try:
        _write(image, output)
        if not (quiet is None or quiet):
            print(native.table(), end="")
        if raised is not None:
            raise raised
        for message in messages:
            warn(message)
    except BaseException as error:
        if native.has_image:
            _give(image, error)
        raise
    return image


def _write(image: Image, output: Optional[PathLike]) -> None:
    """The files that the options name: what one fails at does not keep the others from being written."""
    problems = []
    for is_wanted, write in ((output is not None and image._native.has_image, lambda: image.save(output)),
                             (True, image._native.write_statistics)):
        try:
            if is_wanted:
                write()
        except Error as error:
            problems.append(error)
    if problems:
        raise problems[0] if len(problems) == 1 else Error("; ".join(map(str, problems)))


def _give(image: Image, error: BaseException) -> None:
    try:
        error.image = image  # type: ignore[attr-defined]
    except (AttributeError, TypeError):  # an exception without room for it
        pass


def explain(scene: Union[Scene, PathLike], **options: "Unpack[LoadOptions]") -> List[Dict[str, str]]:
    """How a render would be executed, and why: ``{"option", "value", "reason"}`` of each choice.

    Args and errors are those of :func:`render`, which it prepares but does not begin.
    """
    if not isinstance(scene, Scene):
        return explain(load(scene, **options))
    check_of_render(options)
    merged = {**scene._options, **options}
    output = merged.pop("output", None)
    for name in ("quiet", "explain"):
        merged.pop(name, None)
    return scene._native.plan(_words(merged, output))


class SceneInfo(NamedTuple):
    """A built-in scene."""

    name: str  #: for :func:`load`
    parameter: str  #: what may follow the name and a colon, in a word; empty: nothing
    description: str


class DeviceInfo(NamedTuple):
    """A device of this machine."""

    name: str  #: for ``device=``
    model: str
    detail: str


def scenes() -> List[SceneInfo]:
    """The built-in scenes."""
    return [SceneInfo(*scene) for scene in _ptexp.scenes()]


def devices() -> List[DeviceInfo]:
    """The CPU, then the GPUs that can be used."""
    return [DeviceInfo(*device) for device in _ptexp.devices()]


def options() -> List[Dict[str, str]]:
    """The table of options: keyword, name on the command line, placeholder, group, help, default."""
    return _ptexp.options()


render.__doc__ = f"{render.__doc__}\n{as_documentation()}\n" if render.__doc__ else None
for _function, _kind in ((load, "load"), (load_string, "load"), (render, "load"), (explain, "load"),
                         (Scene.render, "render"), (Scene.from_dict.__func__, "render")):
    show_keywords(_function, _kind)
