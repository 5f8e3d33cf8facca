"""Files that the page cache has not, so that a process reads them from the disk. No root is needed:
posix_fadvise(DONTNEED) drops what is clean and mapped by nobody, and fsync makes it clean."""
import contextlib
import ctypes
import mmap
import os

from lib.description import Refused
from lib.provenance import files_beside

LIBC = ctypes.CDLL(None, use_errno=True)
LIBC.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
LIBC.mmap.restype = ctypes.c_void_p
LIBC.mincore.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p]
LIBC.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
FAILED = ctypes.c_void_p(-1).value


@contextlib.contextmanager
def opened(path):
    file = os.open(path, os.O_RDONLY)
    try:
        yield file
    finally:
        os.close(file)


def is_cached(path):
    """Whether a page of the file is in memory. None if nobody says: mincore (2) tells it to who may
    write the file. To try and read would bring it into the cache."""
    status = os.stat(path)
    if not status.st_size:
        return False
    if status.st_uid != os.geteuid() and not os.access(path, os.W_OK):
        return None
    with opened(path) as file:
        begin = LIBC.mmap(None, status.st_size, mmap.PROT_READ, mmap.MAP_SHARED, file, 0)
        if begin == FAILED:
            return None
        pages = ctypes.create_string_buffer(-(-status.st_size // mmap.PAGESIZE))
        code = LIBC.mincore(begin, status.st_size, pages)
        LIBC.munmap(begin, status.st_size)
    return None if code else any(page & 1 for page in pages.raw)


def drop(scene):
    """A scene's file and what lies beside and below it leave the page cache. Refused where they
    stay, as in a file system in memory."""
    for path in files_beside(scene):
        with opened(path) as file:
            os.fsync(file)
            os.posix_fadvise(file, 0, 0, os.POSIX_FADV_DONTNEED)
        if is_cached(path):
            raise Refused(f"{path} stays in the page cache: is it on a disk?")


def fill(scene):
    """The same files are read, so that no process needs the disk."""
    for path in files_beside(scene):
        with open(path, "rb") as file:
            while file.read(1 << 24):
                pass
