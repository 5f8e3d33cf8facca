"""What an MPI library's launcher is, by what it says of itself."""
import re
import subprocess


def version(launcher):
    """The text of `launcher --version`."""
    run = subprocess.run([launcher, "--version"], capture_output=True, text=True, check=False)
    return run.stdout + run.stderr


def is_open_mpi(launcher):
    return "Open" in version(launcher)


def loses_exit_codes(launcher):
    """MPICH's launcher before 4.1 may return 0 after a signal that it has passed on: it takes ranks
    that end then for killed by itself (https://github.com/pmodels/mpich/pull/5930)."""
    found = re.search(r"HYDRA.*?Version:\s*(\d+)\.(\d+)", version(launcher), re.S)
    return found is not None and tuple(map(int, found.groups())) < (4, 1)
