"""What each kernel needs, from the column `kernels` of ptexp's CSV (docs/statistics.md), and the
multiprocessors that it runs on."""
import re
from dataclasses import dataclass


@dataclass
class Kernel:
    registers: int  # per thread
    spill_bytes: int  # per thread
    shared_bytes: int  # per block
    block_threads: int
    occupancy: float  # resident warps by the most that a multiprocessor holds


def kernels_of(row):
    """{name: Kernel}; empty on the CPU."""
    found = {}
    for entry in filter(None, row.get("kernels", "").split(";")):
        name, registers, spills, shared, threads, occupancy = entry.split(":")[:6]
        found[name] = Kernel(int(registers), int(spills), int(shared), int(threads),
                             float(occupancy))
    return found


def multiprocessors_of(detail):
    """Of the whole GPU, by the text of --list-devices; 0: it says none, as of a CPU."""
    found = re.search(r"(\d+) multiprocessors", detail)
    return int(found[1]) if found else 0


def set_occupancy(row):
    """The column `occupancy`: that of the kernel which finds hits; empty on the CPU."""
    kernels = kernels_of(row)
    kernel = kernels.get("megakernel") or kernels.get("intersect") or kernels.get("bounce")
    row["occupancy"] = f"{kernel.occupancy:.4f}" if kernel else ""
