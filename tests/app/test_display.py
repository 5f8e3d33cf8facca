"""`ptexp --display`: a server in the place of tev decodes what it is sent, by tev's README alone.

The environment variable PTEXP names the executable.
"""
import os
import re
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
TIMEOUT_S = 120


class Packet:
    """The operands of one, taken in their order."""

    def __init__(self, data):
        self.data = data
        self.at = 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def text(self):
        end = self.data.index(b"\0", self.at)
        value = self.data[self.at:end].decode()
        self.at = end + 1
        return value


class Viewer:
    """Shows one image: its floats, and when which of its pixels came."""

    def __init__(self, reads=None):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.reads = reads  # so many packets, then it is gone; 0: none, but it stays
        self.image = None
        self.kept = None  # a connection of which nothing is read
        self.updates = []  # (time in s, width, height)
        self.created = 0
        self.problem = None
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        try:
            connection, _ = self.listener.accept()
            if self.reads == 0:
                self.kept = connection
                return
            with connection, connection.makefile("rb") as stream:
                while head := stream.read(4):
                    length = struct.unpack("<I", head)[0]
                    self.receive(Packet(stream.read(length - 4)))
                    if self.reads is not None:
                        self.reads -= 1
                        if self.reads == 0:
                            return
        except Exception as error:  # pylint: disable=broad-except
            self.problem = error

    def receive(self, packet):
        operation, _ = packet.take("B"), packet.take("B")
        name = packet.text()
        if operation == 4:
            self.name = name
            self.width, self.height, channels = packet.take("iii")
            self.channels = [packet.text() for _ in range(channels)]
            self.image = [0.0] * (3 * self.width * self.height)
            self.created += 1
            assert packet.at == len(packet.data)
            return
        assert operation == 6 and name == self.name, (operation, name)
        channels = packet.take("i")
        assert [packet.text() for _ in range(channels)] == self.channels == ["R", "G", "B"]
        x, y, width, height = packet.take("iiii")
        offsets, strides = packet.take("3q"), packet.take("3q")
        values = packet.take(f"{channels * width * height}f")
        assert packet.at == len(packet.data)
        for row in range(height):
            for column in range(width):
                pixel = row * width + column
                place = 3 * ((y + row) * self.width + x + column)
                for c in range(3):
                    self.image[place + c] = values[offsets[c] + pixel * strides[c]]
        self.updates.append((time.monotonic(), width, height))

    def close(self):
        self.thread.join(timeout=TIMEOUT_S)
        if self.kept:
            self.kept.close()
        self.listener.close()


def write_exr(path, width, height, values):
    """Of 32-bit floats, without compression."""
    def attribute(name, kind, data):
        return f"{name}\0{kind}\0".encode() + struct.pack("<i", len(data)) + data

    channels = b"".join(c + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for c in (b"B", b"G", b"R"))
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join([
        attribute("channels", "chlist", channels + b"\0"),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    size = 8 + 12 * width
    begin = len(header) + 8 * height
    with open(path, "wb") as file:
        file.write(header + struct.pack(f"<{height}Q", *(begin + size * y for y in range(height))))
        for y in range(height):
            row = values[3 * width * y:3 * width * (y + 1)]
            file.write(struct.pack(f"<2i{3 * width}f", y, 12 * width,
                                   *row[2::3], *row[1::3], *row[0::3]))


class Display(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="ptexp display ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def command(self, port, *arguments):
        return [str(word) for word in (PTEXP, "--device", "cpu", "--display",
                                       f"127.0.0.1:{port}", *arguments)]

    def run_shown(self, viewer, *arguments):
        run = subprocess.run(self.command(viewer.port, *arguments), cwd=self.folder, text=True,
                             capture_output=True, check=False, timeout=TIMEOUT_S)
        self.assertEqual(run.returncode, 0, run.stderr)
        viewer.close()
        return run

    def assert_shows(self, viewer, file, crop=None):
        """The image of the viewer has the file's bits."""
        self.assertIsNone(viewer.problem)
        values, width, height = viewer.image, viewer.width, viewer.height
        if crop:
            x0, y0, x1, y1 = crop
            outside = [values[3 * (y * width + x)] for y in range(height) for x in range(width)
                       if not (x0 <= x < x1 and y0 <= y < y1)]
            self.assertEqual(set(outside), {0.0})
            values = [v for y in range(y0, y1)
                      for v in values[3 * (y * width + x0):3 * (y * width + x1)]]
            width, height = x1 - x0, y1 - y0
        write_exr(self.folder / "shown.exr", width, height, values)
        run = subprocess.run([PTEXP, "compare", "shown.exr", file], cwd=self.folder, text=True,
                             capture_output=True, check=False)
        self.assertRegex(run.stdout, r"differing pixels +0\b", run.stderr)

    def test_the_image_grows_and_ends_as_the_file(self):
        for mode in ("serial", "megakernel", "wavefront"):
            with self.subTest(mode=mode):
                viewer = Viewer()
                run = self.run_shown(viewer, "--mode", mode, "--scene", "cornell", "--width", "150",
                                     "--height", "100", "--spp", "60", "-o", "a.exr", "-q")
                self.assertEqual(run.stderr, "")
                self.assertEqual((viewer.name, viewer.created), ("a.exr", 1))
                self.assertEqual((viewer.width, viewer.height), (150, 100))
                self.assert_shows(viewer, "a.exr")
                self.assertGreater(len(viewer.updates), 2, "it was shown once, at its end")

    def test_of_devices_parts_and_chains(self):
        small = ["--scene", "boxes", "--width", "40", "--height", "30", "--spp", "6", "-q"]
        for more, crop in ((["--crop", "7,3,29,30"], (7, 3, 29, 30)),
                           (["--device", "cpu:2"], None),
                           (["--integrator", "mlt", "--time-limit", "2"], None),
                           (["--checkpoint", "c.exr"], None),
                           (["--repeat", "3"], None)):
            with self.subTest(more=more):
                viewer = Viewer()
                self.run_shown(viewer, *small, *more, "-o", "b.exr")
                self.assert_shows(viewer, "b.exr", crop)

    def test_it_is_not_sent_more_than_four_times_a_second(self):
        viewer = Viewer()
        self.run_shown(viewer, "--width", "60", "--height", "60", "--time-limit", "3", "--spp",
                       "1000000", "-o", "t.exr", "-q")
        rounds = 1 + sum(b[0] - a[0] > 0.05 for a, b in zip(viewer.updates, viewer.updates[1:]))
        self.assertLessEqual(rounds, 4 * 3 + 2)
        self.assertGreaterEqual(rounds, 4)

    def test_the_render_goes_on_without_a_viewer(self):
        arguments = ["--width", "40", "--height", "40", "--spp", "4", "-o", "n.exr", "-q"]
        with self.subTest("nobody listens"):
            silent = socket.socket()
            silent.bind(("127.0.0.1", 0))  # so that nobody else does
            run = subprocess.run(self.command(silent.getsockname()[1], *arguments), cwd=self.folder, text=True,
                                 capture_output=True, check=False, timeout=TIMEOUT_S)
            silent.close()
            self.assertEqual(run.returncode, 0)
            self.assertRegex(run.stderr, r"^ptexp: warning: --display 127\.0\.0\.1:\d+: Connection "
                                         r"refused; the render is not shown\n$")
        with self.subTest("it is closed meanwhile"):
            viewer = Viewer(reads=2)
            run = self.run_shown(viewer, "--width", "300", "--height", "200", "--time-limit", "2",
                                 "--spp", "1000000", "-o", "n.exr", "-q")
            self.assertRegex(run.stderr, r"^ptexp: warning: --display .*; no more is shown\n$")
        with self.subTest("it takes nothing"):
            viewer = Viewer(reads=0)
            begin = time.monotonic()
            run = self.run_shown(viewer, "--width", "1500", "--height", "1500", "--spp", "2",
                                 "-o", "n.exr", "-q")
            seconds = time.monotonic() - begin
            self.assertRegex(run.stderr, "does not take what is sent to it; no more is shown")
            self.assertLess(seconds, 60)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["n.exr"])

    def test_ctrl_c_is_not_kept_waiting(self):
        viewer = Viewer(reads=0)
        process = subprocess.Popen(self.command(viewer.port, "--width", "1000", "--height", "1000",
                                                "--spp", "1000000", "-o", "i.exr", "-q"),
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        time.sleep(4)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=TIMEOUT_S)
        self.assertLess(time.monotonic() - begin, 5)
        self.assertEqual(process.returncode, 130, err)
        viewer.close()

    def test_bad_addresses_are_refused(self):
        for address in ("a:b", "a:70000", "::1"):
            run = subprocess.run([PTEXP, "--display", address], capture_output=True, text=True,
                                 check=False)
            self.assertEqual(run.returncode, 2)
            self.assertTrue(re.match(rf"ptexp: error: --display {address}: expected HOST:PORT",
                                     run.stderr), run.stderr)


if __name__ == "__main__":
    unittest.main()
