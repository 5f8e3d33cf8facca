"""Pairs of pictures, NAME.png and NAME.reference.png: a slider between them, and their difference.
The browser makes the difference (mix-blend-mode), so that nothing but the two files is needed."""
import base64
from html import escape

from .tables import printable

REFERENCE = ".reference.png"


def embedded(path):
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def pairs(folder):
    for reference in sorted(folder.glob(f"*{REFERENCE}")):
        picture = reference.with_name(reference.name.removesuffix(REFERENCE) + ".png")
        if picture.is_file():
            yield picture, reference


def one_pair(picture, reference):
    name = escape(printable(picture.stem))
    return f"""<figure class="pair">
<div class="frame"><img src="{embedded(reference)}" alt="{name}: the reference">
<img class="over" src="{embedded(picture)}" alt="{name}"></div>
<figcaption><b>{name}</b> left of the line, its reference right of it</figcaption>
<div class="controls"><label>Border <input type="range" class="slider" min="0" max="100" value="50">
</label> <label><input type="checkbox" class="difference"> difference</label>
<label>times <input type="range" class="gain" min="0" max="6" value="3"> <output>8</output></label>
</div></figure>
"""


def image_section(folder, limit_bytes):
    """The pairs of a folder; those with a larger file are named instead."""
    parts, left_out = [], []
    for picture, reference in pairs(folder):
        if max(picture.stat().st_size, reference.stat().st_size) > limit_bytes:
            left_out.append(picture.stem)
        else:
            parts.append(one_pair(picture, reference))
    if left_out:
        parts.append(f'<p class="note">Larger than {limit_bytes // 1024} KiB and so not on this '
                     f'page: {escape(printable(", ".join(left_out)))}.</p>')
    return "".join(parts)
