"""Ranks by MPI: tests/mpi/ranks_program.cpp, started by mpiexec.

PTEXP_RANKS names the program and MPIEXEC the launcher of the same MPI; skips without them. With
PTEXP_TEST_LARGE set, more than 2 GB are broadcast.
"""
import os
import re
import signal
import subprocess
import time
import unittest

from mpi_launcher import is_open_mpi, loses_exit_codes

PROGRAM = os.environ.get("PTEXP_RANKS")
MPIEXEC = os.environ.get("MPIEXEC")
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
LAUNCHER = re.compile("OMPI_|PMI|PMIX_|MPI_|SLURM_|PTEXP_")
PARTIAL = re.compile(r"(\d+) units, not right, 0 errors")


def environment(**variables):
    """Without what another launcher may have left."""
    clean = {key: value for key, value in os.environ.items() if not LAUNCHER.match(key)}
    return {**clean, **AS_ROOT, **variables}


@unittest.skipUnless(PROGRAM and MPIEXEC, "no MPI was found")
class Mpirun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.launcher = [MPIEXEC] + (["--oversubscribe"] if is_open_mpi(MPIEXEC) else [])

    def command(self, ranks, *arguments):
        return [*self.launcher, "-n", str(ranks), PROGRAM, *map(str, arguments)]

    def start(self, ranks, *arguments, limit_s=60, **variables):
        """Returns (exit code, stdout, the program's own messages)."""
        run = subprocess.run(self.command(ranks, *arguments), capture_output=True, text=True,
                             check=False, timeout=limit_s, env=environment(**variables))
        messages = [line for line in run.stderr.splitlines() if line.startswith("ptexp:")]
        return run.returncode, run.stdout, messages

    def assert_right(self, ranks, *arguments, errors=0, **variables):
        code, out, messages = self.start(ranks, *arguments, **variables)
        self.assertEqual((code, messages), (0, []), out)
        self.assertIn(f"800 units, right, {errors} errors", out)
        return out

    def assert_error(self, pattern, ranks, *arguments, limit_s=60, most=1, **variables):
        begin = time.monotonic()
        code, out, messages = self.start(ranks, *arguments, limit_s=limit_s, **variables)
        self.assertEqual(code, 2, out)
        self.assertLessEqual(len(messages), most, messages)
        self.assertRegex(messages[0], "^ptexp: error: " + pattern)
        self.assertNotIn("agreed", out)
        return time.monotonic() - begin

    def test_units_of_any_number_of_ranks(self):
        for ranks in (1, 2, 3, 4, 7):
            with self.subTest(ranks=ranks):
                out = self.assert_right(ranks, "units", 2, -1)
                self.assertIn(f"{2 * ranks} workers", out)
                self.assertRegex(out, r"the last one (rank %d \(\S+\) )?cpu:1: device of cpu:1"
                                 % (ranks - 1))

    def test_messages_in_many_parts(self):
        self.assert_right(3, "units", 1, -1, PTEXP_MPI_CHUNK="100")
        code, out, _ = self.start(3, "broadcast", 1000003, PTEXP_MPI_CHUNK="4099")
        self.assertEqual(code, 0)
        self.assertIn("3 of 3 right", out)

    def test_broadcast(self):
        sizes = [0, 1, 50_000_001] + ([3 << 30] if os.environ.get("PTEXP_TEST_LARGE") else [])
        for size in sizes:
            code, out, _ = self.start(3, "broadcast", size, limit_s=300)
            self.assertEqual(code, 0)
            self.assertIn("3 of 3 right", out, size)

    def test_a_broken_device_is_not_the_end(self):
        code, out, messages = self.start(3, "units", 1, 1)
        self.assertEqual((code, messages), (0, []))
        self.assertRegex(out, "800 units, right, [12] errors")

    def test_an_exception_ends_all_and_is_reported_once(self):
        self.assert_error(r"rank 2 \(\S+\): planted$", 4, "exception", 2)
        self.assert_error("planted$", 4, "exception", 0)

    def test_what_does_not_fit_is_refused_by_name(self):
        self.assert_error(r"rank 2 \(\S+\): expected options width 8, has width 9$", 4,
                          "mismatch", 2)
        self.assertEqual(self.start(4, "mismatch", 9), (0, "agreed\n" * 4, []))

    def test_the_exit_code_is_that_of_rank_0(self):
        self.assertEqual(self.start(3, "code", 7)[0], 7)

    def test_a_killed_rank_is_the_end(self):
        for rank in (0, 2):
            begin = time.monotonic()
            code, _, _ = self.start(4, "kill", rank)
            self.assertNotEqual(code, 0)
            self.assertLess(time.monotonic() - begin, 20)  # 10 on a machine that is not busy

    def test_a_silent_rank_is_the_end(self):
        for rank in (0, 2):
            seconds = self.assert_error(rf"rank {rank} \(\S+\) has been silent for 3 s", 4, "hang",
                                        rank, PTEXP_MPI_TIMEOUT="3", most=3)
            self.assertLess(seconds, 20)

    def test_a_busy_rank_is_not_silent_and_a_waiting_one_not_busy(self):
        out = self.assert_right(3, "quiet", 5000, PTEXP_MPI_TIMEOUT="2")
        self.assertLess(float(out.split(" %")[0]), 20)

    def test_suspended_together_they_go_on(self):
        self.assert_right(3, "suspend", 8, PTEXP_MPI_TIMEOUT="3")

    def interrupt(self, number, send):
        with subprocess.Popen(self.command(3, "interrupt"), stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.PIPE, env=environment()) as run:
            while "ready" not in run.stderr.readline():
                self.assertIsNone(run.poll())
            time.sleep(0.3)
            send(run, number)
            out, _ = run.communicate(timeout=30)
        self.assertRegex(out, PARTIAL)
        return run.returncode

    def test_signals_to_the_launcher_keep_what_there_is(self):
        code = self.interrupt(signal.SIGUSR1, subprocess.Popen.send_signal)
        if code != 0 or not loses_exit_codes(MPIEXEC):
            self.assertEqual(code, 128 + signal.SIGUSR1)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.interrupt(number, subprocess.Popen.send_signal)  # launchers choose the code

    def test_signals_to_all_ranks_keep_what_there_is(self):
        def send_to_all(run, number):
            ranks = subprocess.run(["pgrep", "-f", "^" + re.escape(PROGRAM) + " interrupt"],
                                   capture_output=True, text=True, check=True).stdout.split()
            self.assertEqual(len(ranks), 3)
            for rank in ranks:
                os.kill(int(rank), number)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.assertEqual(self.interrupt(number, send_to_all), 128 + number)

    def test_without_a_launcher_it_is_alone(self):
        run = subprocess.run([PROGRAM, "units", "2", "-1"], capture_output=True, text=True,
                             check=True, timeout=60, env=environment())
        self.assertIn("800 units, right, 0 errors, 2 workers", run.stdout)

    def test_a_launcher_of_another_kind_is_an_error(self):
        variables = {"PMI_SIZE" if is_open_mpi(MPIEXEC) else "OMPI_COMM_WORLD_SIZE": "3"}
        run = subprocess.run([PROGRAM, "where"], capture_output=True, text=True, check=False,
                             timeout=60, env=environment(**variables))
        self.assertEqual(run.returncode, 2)
        self.assertIn("started 3 processes, but MPI connects 1 of them", run.stderr)
        run = subprocess.run([PROGRAM, "where"], capture_output=True, text=True, check=True,
                             timeout=60, env=environment(**variables, PTEXP_LAUNCHER="off"))
        self.assertIn("of 1, 0/1", run.stdout)


if __name__ == "__main__":
    unittest.main()
