"""Puts the rays of a file in another order (src/common/rays/ray_file.h has the format)."""
import array
import random
import struct
import sys
from pathlib import Path

HEADER, RECORD = 32, 32  # bytes; a record: origin, t_min, direction, t_max
MAGIC = b"TRBRAYS1"
BITS = 10  # of a coordinate in a Morton number
# The bits of a number with two zeros after each.
SPREAD = [sum((n >> bit & 1) << 3 * bit for bit in range(BITS)) for n in range(1 << BITS)]


def cells(values):
    """Of all coordinates along an axis, their cells of a grid over what they span."""
    low = min(values)
    scale = ((1 << BITS) - 1) / ((max(values) - low) or 1)
    return [SPREAD[int((value - low) * scale)] for value in values]


def morton(floats):
    """The Morton number of each ray's origin."""
    return [x | y << 1 | z << 2 for x, y, z in zip(*(cells(floats[axis::8]) for axis in range(3)))]


def octants(floats):
    """Which of eight ways each direction points."""
    return [(x < 0) | (y < 0) << 1 | (z < 0) << 2
            for x, y, z in zip(*(floats[4 + axis::8] for axis in range(3)))]


def places(floats, order):
    """The rays' numbers in the order that is asked for."""
    count = len(floats) // 8
    if order == "shuffled":
        numbers = list(range(count))
        random.Random(1).shuffle(numbers)
        return numbers
    keys = morton(floats)
    if order == "direction":
        keys = [octant << 3 * BITS | key for octant, key in zip(octants(floats), keys)]
    return sorted(range(count), key=keys.__getitem__)


def reorder(path, order):
    """`order`: "shuffled"; "origin", by the Morton number of the origin; or "direction", by octant
    and then by origin. Equal keys keep their order."""
    content = Path(path).read_bytes()
    magic, count = struct.unpack_from("<8sQ", content)
    if magic != MAGIC or len(content) != HEADER + RECORD * count:
        raise ValueError(f"{path}: not a file of rays")
    floats = array.array("f", content[HEADER:])
    if sys.byteorder == "big":
        floats.byteswap()
    rays = memoryview(content)[HEADER:]
    Path(path).write_bytes(content[:HEADER] + b"".join(
        rays[RECORD * number:RECORD * (number + 1)] for number in places(floats, order)))
