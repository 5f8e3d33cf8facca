#!/usr/bin/env python3
"""Usage: scripts/gallery.py PTEXP FOLDER

Renders every built-in scene, small and on the CPU, into FOLDER/gallery/*.png, and writes
FOLDER/gallery.md, which shows them with their licences. Scenes of others are only named.
"""
import subprocess
import sys
from pathlib import Path

SIZE = ["--width", "320", "--height", "180", "--device", "cpu", "--quiet"]
MLT = ["--integrator", "mlt", "--max-depth", "12", "--bootstrap", "65536"]
OPTIONS = {"furnace": ["--spp", "1"], "terrain": ["--scene", "terrain:50K"],
           "statue": ["--scene", "statue:50K"], "boxes": ["--max-depth", "8"], "ajar": MLT,
           "caustic": MLT, "dial": ["--scene", "dial:8:1:open", "--max-depth", "8"]}
FIRST = """# Gallery

The scenes that ptexp makes itself, rendered on the CPU with {spp} samples per pixel unless stated. They
are parts of the program, under its licence (MIT); the pictures too.

"""
LAST = """## Scenes of others

Tests and measurements read these from files that are not a part of ptexp.

scene | author | licence
---|---|---
Cornell Box | Benedikt Bitterli | CC0
Modern Hall | NewSee2l035 | CC BY 3.0
The Grey & White Room | Wig42 | CC BY 3.0
Balloon | see the license.txt beside it | see there
"""


def scenes(ptexp):
    """(name, description) of each that is built in."""
    text = subprocess.run([ptexp, "--list-scenes"], check=True, capture_output=True, text=True)
    for line in text.stdout.splitlines():
        usage, description = line.split(None, 1)
        yield usage.partition("[")[0], description


def main():
    if len(sys.argv) != 3 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    ptexp, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    (folder / "gallery").mkdir(parents=True, exist_ok=True)
    spp = "32"
    page = FIRST.format(spp=spp)
    for name, description in scenes(ptexp):
        options = ["--scene", name, "--spp", spp, *OPTIONS.get(name, [])]
        picture = f"gallery/{name}.png"
        subprocess.run([ptexp, *SIZE, *options, "--output", folder / picture], check=True)
        own = OPTIONS.get(name, [])
        shown = " ".join(["ptexp", *([] if "--scene" in own else ["--scene", name]), *own])
        page += f"## {name}\n\n![{name}]({picture})\n\n`{shown}`: {description}.\n\n"
    (folder / "gallery.md").write_text(page + LAST, encoding="utf-8")


if __name__ == "__main__":
    main()
