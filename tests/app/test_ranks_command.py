"""ptexp under mpirun, as a user starts it: any number of ranks makes the image of one process.

The environment variable PTEXP names the executable; MPIRUN, where it is set, the launcher.
"""
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "mpi"))
from mpi_launcher import is_open_mpi, loses_exit_codes  # noqa: E402
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
TIMEOUT_S = 300
SMALL = ["--device", "cpu", "--threads", 1, "--width", 64, "--height", 48, "--max-depth", 6]
SCENE = """<scene version="3.0.0">
  <sensor type="perspective"><transform name="to_world">
    <lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform></sensor>
  <emitter type="constant"/>
  <shape type="obj"><string name="filename" value="more/mesh.obj"/>
    <bsdf type="diffuse"><texture name="reflectance" type="bitmap">
      <string name="filename" value="more/map.ppm"/></texture></bsdf></shape>
  <shape type="sphere"><point name="center" x="1" y="0" z="0"/></shape></scene>"""


def library():
    """The program's MPI: "Open MPI v4.1.4", "MPICH ...", or "off"."""
    text = subprocess.run([PTEXP, "--version"], capture_output=True, text=True, check=True).stdout
    return re.search(r"^MPI (.*)$", text, re.M)[1]


def launcher():
    """mpirun of the program's library, or why there is none."""
    name = library()
    if name == "off":
        return None, "the program was built without MPI"
    wanted = "mpirun.openmpi" if "Open MPI" in name else "mpiexec.mpich"
    found = os.environ.get("MPIRUN") or shutil.which(wanted) or shutil.which("mpirun")
    return found, f"no launcher of {name}"


class Ranks(unittest.TestCase):
    def setUp(self):
        self.mpirun, why = launcher()
        if not self.mpirun:
            self.skipTest(why)
        folder = tempfile.TemporaryDirectory(prefix="ptexp ranks ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "PTEXP_MPI_TIMEOUT": "20"}

    def command(self, ranks, arguments):
        oversubscribe = ["--oversubscribe"] if is_open_mpi(self.mpirun) else []
        return [self.mpirun, *oversubscribe, "-n", str(ranks), str(PTEXP), *map(str, arguments)]

    def run_ranks(self, ranks, *arguments):
        return subprocess.run(self.command(ranks, arguments), cwd=self.folder, capture_output=True,
                              stdin=subprocess.DEVNULL, text=True, check=False, timeout=TIMEOUT_S,
                              env=self.environment)

    def run_one(self, *arguments):
        run = subprocess.run([PTEXP, *map(str, arguments)], cwd=self.folder, capture_output=True,
                             stdin=subprocess.DEVNULL, text=True, check=False, timeout=TIMEOUT_S)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run

    def wait_for(self, name):
        """Until the render at work has written the file, however busy the machine is."""
        end = time.monotonic() + TIMEOUT_S
        while not (self.folder / name).exists():
            self.assertLess(time.monotonic(), end, f"no {name}")
            time.sleep(0.01)

    def assert_same_image(self, a, b):
        run = self.run_one("compare", a, b)
        self.assertRegex(run.stdout, r"differing pixels +0\b")

    def test_any_number_makes_the_image_of_one(self):
        for scene in (["--scene", "spheres", "--mode", "megakernel"],
                      ["--scene", "instances:20", "--filter", "mitchell", "--crop", "3,5,60,40"],
                      ["--scene", "boxes", "--aov", "albedo,primitive,variance"]):
            self.run_one(*SMALL, *scene, "--spp", 8, "--quiet", "-o", "one.exr")
            for ranks in (1, 2, 3, 4, 7):
                with self.subTest(scene=scene, ranks=ranks):
                    run = self.run_ranks(ranks, *SMALL, *scene, "--spp", 8, "-o", "ranks.exr")
                    self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                    self.assert_same_image("ranks.exr", "one.exr")
                    # One process prints, and its table has all devices.
                    self.assertEqual(run.stdout.count("wrote ranks.exr"), 1, run.stdout)
                    rows = re.findall(r"^(?:cpu:0|rank \d+ \(.+\) cpu:0) ", run.stdout, re.M)
                    self.assertEqual(len(rows), ranks if ranks > 1 else 0, run.stdout)

    def test_ranks_that_compute_seldom_wake(self):
        """Threads that wait take the core on which their device computes: 10,000 looks per second
        cost a fifth of it."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_nvcsw
        begin = time.monotonic()
        run = self.run_ranks(2, *SMALL, "--scene", "boxes", "--spp", 600, "-o", "a.exr")
        seconds = time.monotonic() - begin
        self.assertEqual(run.returncode, 0, run.stderr)
        wakes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_nvcsw - before
        self.assertLess(wakes / seconds, 14000)  # four threads wait: 8,100 to 9,300; it was 20,000

    def test_scene_files_come_from_the_first_rank(self):
        (self.folder / "more").mkdir()
        (self.folder / "scene.xml").write_text(SCENE)
        (self.folder / "more/mesh.obj").write_text(
            "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        (self.folder / "more/map.ppm").write_bytes(b"P6\n2 1\n255\n\xff\0\0\0\xff\0")
        scene = [*SMALL, "--scene", "scene.xml", "--spp", 8]
        self.run_one(*scene, "-o", "one.exr")
        before = set(Path("/dev/shm").glob("ptexp-*"))
        for more in ([], ["--scene-from-disk"]):
            run = self.run_ranks(3, *scene, *more, "-o", "ranks.exr")
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            self.assert_same_image("ranks.exr", "one.exr")
        self.assertEqual(set(Path("/dev/shm").glob("ptexp-*")), before)
        (self.folder / "more/mesh.obj").unlink()
        run = self.run_ranks(3, *scene, "-o", "ranks.exr")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertEqual(len(re.findall("ptexp: warning: .*mesh.obj", run.stderr)), 1, run.stderr)
        self.run_one(*scene, "-o", "one.exr")
        self.assert_same_image("ranks.exr", "one.exr")
        (self.folder / "scene.xml").write_text(SCENE.replace("</scene>", ""))
        run = self.run_ranks(3, *scene, "-o", "ranks.exr")
        self.assertEqual(run.returncode, 2)
        self.assertEqual(len(re.findall("ptexp: error: .*scene.xml", run.stderr)), 1, run.stderr)

    def test_errors_are_said_once(self):
        for arguments, text in ((["--spp", 0], "--spp 0"),
                                (["--scene", "nothing.xml"], "nothing.xml"),
                                (["--integrator", "mlt"], "the whole image"),
                                (["-o", "/no/such/folder/a.exr"], "/no/such/folder")):
            with self.subTest(arguments):
                run = self.run_ranks(3, *SMALL, *arguments)
                self.assertEqual(run.returncode, 2, run.stderr)
                self.assertEqual(run.stderr.count("ptexp: error:"), 1, run.stderr)
                self.assertIn(text, run.stderr)

    def test_a_rank_of_other_options_is_named(self):
        command = self.command(2, [*SMALL, "--spp", 4, "-o", "a.exr"])
        other = [":", "-n", "1", str(PTEXP), *map(str, SMALL), "--spp", "5", "-o", "a.exr"]
        run = subprocess.run([*command, *other], cwd=self.folder, capture_output=True, text=True,
                             check=False, timeout=TIMEOUT_S, env=self.environment)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertRegex(run.stderr, r"ptexp: error: rank 2 \(.+\): .*--spp 5")
        self.assertFalse((self.folder / "a.exr").exists())

    def test_a_checkpoint_of_some_ranks_goes_on_on_others(self):
        scene = [*SMALL, "--scene", "cornell", "--spp", 3000, "--seed", 3]
        self.run_one(*scene, "-o", "one.exr")
        process = subprocess.Popen(self.command(3, [*scene, "--checkpoint", "c.exr,0.2", "-o", "a.exr"]),
                                   cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        self.wait_for("c.exr")
        process.send_signal(signal.SIGUSR1)  # mpirun passes it on
        _, said = process.communicate(timeout=TIMEOUT_S)
        self.assertIn("ptexp: interrupted", said)
        if process.returncode != 0 or not loses_exit_codes(self.mpirun):
            self.assertEqual(process.returncode, 128 + signal.SIGUSR1, said)
        run = self.run_ranks(2, "resume", "c.exr", "-o", "b.exr")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assert_same_image("b.exr", "one.exr")

    def test_a_killed_rank_ends_all(self):
        """All end within 10 s, non-zero, and the checkpoint goes on to the same bits."""
        scene = [*SMALL, "--scene", "cornell", "--spp", 3000, "--seed", 4]
        self.run_one(*scene, "-o", "one.exr")
        process = subprocess.Popen(self.command(4, [*scene, "--checkpoint", "c.exr,0.1", "-o", "a.exr"]),
                                   cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        self.wait_for("c.exr")
        of_ours = subprocess.run(["pgrep", "-f", f"^{PTEXP} .*--seed 4"], capture_output=True,
                                 text=True, check=False).stdout.split()
        self.assertEqual(len(of_ours), 4)
        os.kill(int(random.choice(of_ours)), signal.SIGKILL)
        begin = time.monotonic()
        self.assertNotEqual(process.wait(timeout=TIMEOUT_S), 0)
        self.assertLess(time.monotonic() - begin, 10)
        run = self.run_one("resume", "c.exr", "-o", "b.exr")
        self.assert_same_image("b.exr", "one.exr")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["b.exr", "c.exr", "one.exr"],
                         run.stderr)


if __name__ == "__main__":
    unittest.main()
