#!/usr/bin/env python3
"""Adds to a wheel that auditwheel has repaired the licences of what is in it.

    scripts/wheel_licences.py WHEEL

These are the libraries in ptexp.libs/ and those whose headers are compiled into the module. Their
texts are /usr/share/doc/PACKAGE/copyright of this Debian, and nanobind's own files; they go into the
wheel's dist-info/licenses/, and its metadata lists them. Fails where a text is not there.
"""
import base64
import hashlib
import re
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

# Debian packages of headers whose code is in the module. NanoVDB's is there where it was built in.
HEADERS = ["libglm-dev", "libcli11-dev", "nlohmann-json3-dev", "libtinygltf-dev", "libstb-dev",
           "libxxhash-dev"]
NANOVDB = "libnanovdb-dev"


def package_of(library):
    """The Debian package of a library as auditwheel names it: libpng16-0123abcd.so.16.39.0"""
    name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", Path(library).name)
    found = subprocess.run(["dpkg-query", "--search", f"*/{name}"], capture_output=True, text=True,
                           check=False).stdout
    packages = sorted({line.partition(":")[0] for line in found.splitlines()})
    if not packages:
        raise ValueError(f"{library}: no Debian package here has {name}")
    return packages[0]


def copyright_of(package):
    path = Path("/usr/share/doc", package, "copyright")
    if not path.is_file():
        raise ValueError(f"{path}: no such file; a tree without documentation has no licences")
    return path.read_bytes()


def nanobind_licences():
    """{name: text} of nanobind, and of robin_map in it, whose licence begins its header."""
    files = {path.name: path for path in metadata.files("nanobind") or []}
    for name in ("LICENSE", "robin_map.h"):
        if name not in files:
            raise ValueError(f"nanobind: this Python's package has no {name}")
    comment = files["robin_map.h"].read_text(encoding="utf-8").partition("*/")[0]
    return {"nanobind/LICENSE": files["LICENSE"].read_binary(),
            "robin_map/LICENSE": comment.lstrip("/* \n").encode()}


def licences(names):
    """{path below licenses/: text} for a wheel with these files."""
    packages = {package_of(name) for name in names
                if ".libs/" in name and not name.endswith("/")}
    packages.update(HEADERS)
    if any("libblosc" in name for name in names):
        packages.add(NANOVDB)
    texts = {f"third_party/{package}/copyright": copyright_of(package) for package in packages}
    texts.update((f"third_party/{name}", text) for name, text in nanobind_licences().items())
    return dict(sorted(texts.items()))


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def add_licences(wheel):
    """Rewrites the file. Returns the licences' paths."""
    with zipfile.ZipFile(wheel) as archive:
        infos = archive.infolist()
        content = {info.filename: archive.read(info) for info in infos}
    folder = next(name.partition("/")[0] for name in content if name.endswith(".dist-info/METADATA"))
    texts = licences(content)
    lines = "".join(f"License-File: {path}\n" for path in texts)
    content[f"{folder}/METADATA"] = re.sub(
        rb"(?m)^(License-File: .*\n)", lambda match: match[1] + lines.encode(),
        content[f"{folder}/METADATA"], count=1)
    added = {f"{folder}/licenses/{path}": text for path, text in texts.items()}
    content.update(added)
    record = f"{folder}/RECORD"
    content[record] = ("".join(record_line(name, data) for name, data in content.items()
                               if name != record and not name.endswith("/"))
                       + f"{record},,\n").encode()
    date, modes = infos[0].date_time, {info.filename: info.external_attr for info in infos}
    partial = Path(f"{wheel}.partial")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in [*((one, text) for one, text in content.items() if one != record),
                           (record, content[record])]:
            info = zipfile.ZipInfo(name, date)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = modes.get(name, 0o100644 << 16)
            archive.writestr(info, data)
    partial.replace(wheel)
    return list(added)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__.strip())
    try:
        print(f"{sys.argv[1]}: with {len(add_licences(sys.argv[1]))} licences of what it contains")
    except (OSError, ValueError, zipfile.BadZipFile, metadata.PackageNotFoundError) as problem:
        sys.exit(f"wheel_licences.py: error: {problem}")
