"""`ptexp view` as a browser and its enemies use it: by HTTP, and in headless Chromium.

The environment variable PTEXP names the executable (build/release/src/ptexp). With
PTEXP_NEEDS_CHROMIUM=1 a missing Chromium is an error and not a skip. PTEXP_SCREENSHOTS names a
folder for pictures of the page.
"""
import base64
import contextlib
import fcntl
import http.client
import json
import os
import queue
import re
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PTEXP = Path(os.environ.get("PTEXP", ROOT / "build" / "release" / "src" / "ptexp")).resolve()
TIMEOUT_S = 120  # generous: the machine may be busy
SMALL = ("--device", "cpu", "--width", "64", "--height", "48")
ENDLESS = "100000000"  # samples
ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/\n")


def wait_for(condition, what, timeout_s=TIMEOUT_S):
    """The first true value of condition()."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"waited in vain for {what}")


def processor_time_s(pid):
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def read_png(data):
    """(width, height, bytes of the pixels) of an 8-bit RGB PNG; checksums and filters undone."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("no PNG")
    at, kind, packed, width, height = 8, None, b"", 0, 0
    while kind != b"IEND":
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if zlib.crc32(kind + body) != struct.unpack_from(">I", data, at + 8 + length)[0]:
            raise ValueError(f"checksum of {kind}")
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB3x", body)
            if (depth, colour) != (8, 2):
                raise ValueError(f"bit depth {depth}, colour type {colour}")
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, pitch, above, pixels = zlib.decompress(packed), 3 * width, bytes(3 * width), b""
    for y in range(height):
        kind, row = raw[y * (pitch + 1)], bytearray(raw[y * (pitch + 1) + 1:(y + 1) * (pitch + 1)])
        for x in range(pitch):
            left, up = row[x - 3] if x >= 3 else 0, above[x]
            corner = above[x - 3] if x >= 3 else 0
            guess = left + up - corner
            nearest = min((left, up, corner), key=lambda value: abs(guess - value))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        above = bytes(row)
        pixels += above
    return width, height, pixels


class Program(unittest.TestCase):
    def start(self, *options, spp=ENDLESS, scene="cornell"):
        """A program that has printed its address; self.port and self.token are that one's."""
        self.process = subprocess.Popen(
            [PTEXP, "view", scene, "--port", "0", *SMALL, "--spp", spp, *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.process.stderr.close)
        self.addCleanup(self.process.stdout.close)
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        for line in self.process.stdout:
            match = ADDRESS.fullmatch(line)
            if match:
                self.port, self.token = int(match[1]), match[2]
                return self.process
        text = self.process.stderr.read()
        if "built without the library cpp-httplib" in text:
            self.assertIn("install libcpp-httplib-dev", text)
            self.assertNotEqual(os.environ.get("PTEXP_NEEDS_CHROMIUM"), "1", text)
            self.skipTest("the program has no HTTP, and says so")
        self.fail(f"no address: {text}")

    def request(self, method, path, body=None, headers=None):
        """(status, headers, body)"""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT_S)
        with contextlib.closing(connection):
            connection.request(method, path, body, headers or {})
            reply = connection.getresponse()
            return reply.status, reply.headers, reply.read()

    def ask(self, name, method="GET", body=None, headers=None):
        return self.request(method, f"/{self.token}/{name}", body, headers)

    def state(self, viewer="test", after=None):
        query = f"state?viewer={viewer}" + ("" if after is None else f"&after={after}")
        status, headers, body = self.ask(query)
        self.assertEqual((status, headers["Content-Type"]), (200, "application/json"))
        return json.loads(body)

    def state_when(self, condition, what):
        def ask():
            state = self.state()
            return state if condition(state) else None
        return wait_for(ask, what)

    def when_done(self):
        return self.state_when(lambda state: state["status"] == "done", "the last sample")

    def change(self, **settings):
        status, _, body = self.ask("settings", "POST", json.dumps(settings))
        self.assertEqual((status, body), (204, b""))

    def image(self, mode="auto"):
        status, headers, body = self.ask(f"image?mode={mode}")
        self.assertEqual((status, headers["Content-Type"]), (200, "image/png"))
        return read_png(body)

    def rendered(self, *options):
        """The pixels that the program writes."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "image.png"
            subprocess.run([PTEXP, "--scene", "cornell", *SMALL, *options, "-o", file], check=True,
                           capture_output=True, timeout=TIMEOUT_S)
            return read_png(file.read_bytes())

    def assert_idle(self):
        """The program does nothing; its last pass may still be on its way."""
        def rests():
            before = processor_time_s(self.process.pid)
            time.sleep(1.0)
            return processor_time_s(self.process.pid) - before < 0.05
        wait_for(rests, "the work's end", 20)

    def assert_works(self):
        before = processor_time_s(self.process.pid)
        wait_for(lambda: processor_time_s(self.process.pid) - before > 0.3, "work")


class Page(Program):
    def test_is_one_file_that_asks_for_nothing_else(self):
        self.start()
        status, headers, body = self.ask("")
        self.assertEqual(status, 200)
        self.assertEqual(headers["Content-Type"], "text/html; charset=utf-8")
        text = body.decode("utf-8")
        self.assertNotRegex(text, r"https?:|src=|@import|url\(|NONCE")
        nonce = re.search(r"script-src 'nonce-([0-9a-f]{32})'",
                          headers["Content-Security-Policy"]).group(1)
        self.assertEqual(text.count(f'nonce="{nonce}"'), 2)
        self.assertNotIn(nonce, self.ask("")[2].decode("utf-8"), "a nonce is used once")
        self.assertNotEqual(nonce, self.token)

    def test_every_answer_is_careful(self):
        self.start()
        for path in ("/", f"/{self.token}/", f"/{self.token}/state", f"/{self.token}/absent"):
            headers = self.request("GET", path)[1]
            self.assertEqual(len(headers.get_all("Content-Security-Policy")), 1)
            self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
            self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(headers["Cache-Control"], "no-store")
            self.assertEqual(headers["Referrer-Policy"], "no-referrer")
            self.assertNotIn("Access-Control-Allow-Origin", headers)

    def test_every_program_has_its_own_token(self):
        self.start()
        first = self.token
        self.start()
        self.assertNotEqual(first, self.token)
        self.assertEqual(self.request("GET", f"/{first}/")[0], 404)


class Render(Program):
    def test_the_image_is_that_of_the_program(self):
        self.start(spp="20")
        state = self.when_done()
        self.assertEqual([state[key] for key in ("scene", "mode", "spp")],
                         ["cornell", "auto", 20])
        view, = state["views"]
        self.assertEqual((view["mode"], view["samples"]), ("auto", 20))
        self.assertGreater(view["pass_ms"], 0)
        self.assertAlmostEqual(view["msamples_per_s"],
                               64 * 48 * view["pass_samples"] / view["pass_ms"] / 1e3, 6)
        self.assertEqual(self.image(), self.rendered("--spp", "20"))

    def test_exposure_changes_the_picture_alone(self):
        self.start("--exposure", "-1", spp="8")
        first = self.when_done()
        self.assertEqual(first["exposure"], -1)
        self.assertEqual(self.image(), self.rendered("--spp", "8", "--exposure", "-1"))
        self.change(exposure=2)
        state = self.state(after=first["version"])
        self.assertEqual((state["exposure"], state["status"]), (2, "done"))
        self.assertEqual(self.image(), self.rendered("--spp", "8", "--exposure", "2"))

    def test_an_orbit_begins_anew(self):
        self.start(spp="8")
        self.when_done()
        rest = self.image()
        self.change(orbit={"yaw": 25, "pitch": 10, "zoom": 1.2})
        state = self.when_done()
        self.assertEqual(state["orbit"], {"yaw": 25, "pitch": 10, "zoom": 1.2})
        self.assertNotEqual(self.image(), rest)
        self.change(orbit={})
        self.when_done()
        self.assertEqual(self.image(), rest)

    def test_two_modes_side_by_side(self):
        self.start(spp="8")
        self.change(mode="split")
        state = self.when_done()
        self.assertEqual([(view["mode"], view["samples"]) for view in state["views"]],
                         [("wavefront", 8), ("megakernel", 8)])
        self.assertEqual(self.image("megakernel"), self.image("wavefront"))
        self.change(mode="serial")
        self.assertEqual([view["mode"] for view in self.when_done()["views"]], ["serial"])
        self.assertEqual(self.ask("image?mode=megakernel")[0], 204)

    def save(self, form, folder, mode="auto"):
        status, headers, body = self.ask(f"save?mode={mode}&form={form}")
        self.assertEqual(status, 200)
        self.assertEqual(headers["Content-Disposition"],
                         f'attachment; filename="cornell.{form}"')
        file = Path(folder) / f"saved.{form}"
        file.write_bytes(body)
        return file

    def ptexp(self, *arguments):
        return subprocess.run([PTEXP, *arguments], capture_output=True, text=True, check=False,
                              timeout=TIMEOUT_S)

    def test_saved_files_are_those_of_the_program(self):
        """verify renders them again by their headers."""
        self.start("--max-depth", "3", spp="6")
        with tempfile.TemporaryDirectory() as folder:
            self.change(exposure=1)
            self.when_done()
            self.assertEqual(read_png(self.save("png", folder).read_bytes()),
                             self.rendered("--spp", "6", "--max-depth", "3", "--exposure", "1"))
            for orbit in ({}, {"yaw": 25, "pitch": 10, "zoom": 1.2}):
                self.change(orbit=orbit, mode="wavefront", layer="depth")
                self.when_done()
                file = self.save("exr", folder, "wavefront")
                run = self.ptexp("verify", file, "--share", "1")
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                self.assertIn(b"depth.Z", file.read_bytes()[:4096])
            name = json.loads(self.ask("parameters")[2])[0]["name"]
            self.change(parameters={name: [0.1, 0.1, 0.9]})
            self.when_done()
            file = self.save("exr", folder, "wavefront")
            self.assertIn(f"{name}=0.1,0.1,0.9".encode(), file.read_bytes()[:4096])
            self.assertEqual(self.ptexp("verify", file).returncode, 2, "no options give that")

    def test_the_camera_as_options_and_as_lines_of_a_scene(self):
        self.start("--filter", "box", spp="4")
        self.change(orbit={"yaw": 25, "pitch": 10, "zoom": 1.2})
        camera = self.when_done()["camera"]
        moved = self.image()
        self.assertEqual(self.rendered("--spp", "4", *camera["options"].split()), moved)
        self.assertIn('<lookat origin="', camera["xml"])
        self.assertIn('<integer name="width" value="64"/>', camera["xml"])

    def test_layers_are_those_of_the_program(self):
        self.start(spp="4")
        self.change(layer="rays")
        self.when_done()
        status, headers, body = self.ask("image?mode=auto")
        low, high = map(float, headers["X-Range"].split())
        self.assertTrue(1 <= low < high, headers["X-Range"])
        self.assertEqual(status, 200)
        heat = read_png(body)
        self.change(exposure=3, curve="agx")
        self.assertEqual(self.image(), heat, "colours of numbers stay")
        self.change(layer="normal")
        self.state_when(lambda state: state["status"] == "done" and
                        self.ask("image?mode=auto")[0] == 200, "the normals")
        self.assertIsNone(self.ask("image?mode=auto")[1]["X-Range"])
        width, height, pixels = self.image()
        floor = (height - 3) * width + width // 2
        self.assertEqual(pixels[3 * floor:3 * floor + 3], bytes([128, 255, 128]), "up: +y")
        self.change(layer="color", exposure=0, curve="srgb")
        self.when_done()
        self.assertEqual(self.image(), self.rendered("--spp", "4"))

    def test_a_pause_lasts_until_it_goes_on(self):
        self.start()
        self.state_when(lambda state: state["views"][0]["samples"] > 2, "samples")
        self.change(paused=True)
        self.assertEqual(self.state()["status"], "paused")
        time.sleep(0.3)  # the pass that was at work
        samples = self.state()["views"][0]["samples"]
        before = processor_time_s(self.process.pid)
        time.sleep(1.0)  # less than a viewer may be silent
        self.assertLess(processor_time_s(self.process.pid) - before, 0.2)
        self.assertEqual(self.state()["views"][0]["samples"], samples)
        self.change(paused=False)
        self.state_when(lambda state: state["views"][0]["samples"] > samples, "more samples")

    def test_size_and_samples(self):
        self.start(spp="2")
        self.change(size=[40, 30], scale=2, spp=5)
        state = self.when_done()
        self.assertEqual((state["size"], state["scale"], state["spp"]), ([40, 30], 2, 5))
        width, height, pixels = self.image()
        expected = self.rendered("--width", "80", "--height", "60", "--spp", "5")
        self.assertEqual((width, height, pixels), expected)

    def test_news_come_at_once_and_none_soon(self):
        self.start(spp="2")
        version = self.when_done()["version"]
        begin = time.monotonic()
        self.assertEqual(self.state(after=version)["version"], version)
        self.assertGreater(time.monotonic() - begin, 0.5)
        self.assertNotEqual(self.state(after=0)["version"], 0)

    def test_without_viewers_nothing_is_rendered(self):
        self.start()
        self.assert_idle()
        self.assertEqual(json.loads(self.ask("state")[2])["status"], "idle")  # no viewer asks
        self.assertEqual(self.ask("image?mode=auto")[0], 204)
        self.state("a")
        self.state("b")
        self.assert_works()
        self.assertEqual(self.ask("leave?viewer=a", "POST", "")[0], 204)
        self.state("b")
        self.assertEqual(self.state("b")["status"], "rendering")
        self.assertEqual(self.ask("leave?viewer=b", "POST", "")[0], 204)
        self.assertEqual(json.loads(self.ask("state")[2])["status"], "idle")
        self.assert_idle()
        self.state("c")
        self.assert_works()
        self.assert_idle()  # c has said nothing for a while


class Refusals(Program):
    def test_what_is_not_there(self):
        self.start()
        other = ("0" if self.token[0] != "0" else "1") + self.token[1:]
        for path in ("/", "/state", f"/{other}/", f"/{other}/state", f"/{self.token}",
                     f"/{self.token[:-1]}/", f"/{self.token}0/", f"/{self.token}/state/",
                     f"/{other}/save?mode=auto&form=exr", f"/{other}/parameters", "/parameters",
                     f"//{self.token}/", f"/{self.token}//state", "/favicon.ico",
                     f"/{self.token}/../../etc/passwd", f"/{self.token}/..%2f..%2fetc/passwd",
                     f"/{self.token}/%2e%2e/%2e%2e/etc/passwd", f"/{self.token}/./state",
                     f"/{self.token}/st%61te", f"/{self.token}/page.html", "/etc/passwd",
                     f"/%{ord(self.token[0]):x}{self.token[1:]}/", "/../" + self.token + "/",
                     f"http://127.0.0.1:{self.port}/{self.token}/"):
            status, _, body = self.request("GET", path)
            self.assertEqual((status, body), (404, b"nothing is here\n"), path)

    def test_other_methods(self):
        self.start()
        for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"):
            for name in ("", "state", "image", "save", "parameters", "settings"):
                self.assertEqual(self.ask(name, method)[0], 404, f"{method} {name}")
        for name in ("", "state", "image", "save", "parameters"):
            self.assertEqual(self.ask(name, "POST", "{}")[0], 404, name)
        self.assertEqual(self.ask("settings")[0], 404)

    def test_other_hosts(self):
        """A page of another name that leads to 127.0.0.1 sends that name."""
        self.start()
        for host in ("example.org", f"example.org:{self.port}", "127.0.0.1", "", "localhost",
                     f"127.0.0.1:{self.port + 1}", f"127.0.0.1:{self.port}.example.org",
                     f"0.0.0.0:{self.port}", f"[::1]:{self.port}"):
            self.assertEqual(self.ask("", headers={"Host": host})[0], 403, host)
        self.assertEqual(self.ask("", headers={"Host": f"localhost:{self.port}"})[0], 200)
        own = f"Host: 127.0.0.1:{self.port}\r\n"
        for hosts, status in (("", 403), (f"{own}Host: a.example\r\n", 403), (own, 200)):
            self.assertEqual(self.raw(f"GET /{self.token}/ HTTP/1.1\r\n{hosts}\r\n"), status, hosts)

    def test_other_origins(self):
        self.start()
        for origin in ("http://example.org", "null", f"https://127.0.0.1:{self.port}", "http://",
                       f"http://127.0.0.1:{self.port + 1}", f"http://127.0.0.1:{self.port}.example",
                       "http://localhost"):
            for name in ("settings", "leave"):
                status, _, _ = self.ask(name, "POST", "{}", {"Origin": origin})
                self.assertEqual(status, 403, f"{origin} {name}")
        self.assertEqual(self.state()["exposure"], 0)
        own = {"Origin": f"http://127.0.0.1:{self.port}"}
        self.assertEqual(self.ask("settings", "POST", '{"exposure": 1}', own)[0], 204)
        self.assertEqual(self.state()["exposure"], 1)

    def raw(self, text, more=b""):
        """The status of the answer to these bytes; None where there is none."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=TIMEOUT_S) as connection:
            reply = b""
            # The server may answer and close before it has read a body that is too long.
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                connection.sendall(text.encode("ascii") + more)
            with contextlib.suppress(ConnectionResetError):
                while b"\r\n" not in reply:
                    part = connection.recv(4096)
                    if not part:
                        break
                    reply += part
        match = re.match(rb"HTTP/1.1 (\d+) ", reply)
        return int(match[1]) if match else None

    def post(self, headers, body=b""):
        return self.raw(f"POST /{self.token}/settings HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n"
                        f"{headers}\r\n", body)

    def test_bodies(self):
        self.start()
        self.assertEqual(self.post("Content-Length: 2\r\n", b"{}"), 204)
        blank = b"{" + b" " * 4094 + b"}"
        self.assertEqual(self.post("Content-Length: 4096\r\n", blank), 204)
        self.assertEqual(self.post("Content-Length: 4097\r\n", blank + b" "), 413)
        self.assertEqual(self.post("Content-Length: 1048576\r\n"), 413, "before it is read")
        self.assertEqual(self.post("Content-Length: 1048576\r\nExpect: 100-continue\r\n"), 413)
        self.assertEqual(self.post("Content-Length: 99999999999999999999\r\n"), 413)
        self.assertEqual(self.post("Content-Length: -1\r\n"), 400)
        self.assertEqual(self.post("Content-Length: 2\r\nContent-Length: 3\r\n", b"{}"), 400)
        self.assertEqual(self.post(""), 411)
        self.assertEqual(self.post("Transfer-Encoding: chunked\r\n", b"2\r\n{}\r\n0\r\n\r\n"), 411)
        self.assertEqual(self.post("Content-Length: 2\r\nTransfer-Encoding: chunked\r\n"), 411)
        self.assertEqual(self.post("Content-Length: 2\r\nContent-Encoding: gzip\r\n", b"{}"), 415)
        self.assertEqual(self.post("Content-Length: 2\r\n"
                                   "Content-Type: multipart/form-data; boundary=x\r\n", b"{}"), 415)
        self.assertIn(self.post("Content-Length: 1048576\r\n", bytes(1048576)), (413, None))
        self.assertEqual(self.state()["exposure"], 0)

    def test_settings_that_are_none(self):
        self.start()
        for body, words in (("", "JSON object"), ("[1]", "JSON object"), ("{", "JSON object"),
                            ('{"exposure": "bright"}', '"exposure": expected a number from'),
                            ('{"mode": "fast"}', '"mode": expected one of auto'),
                            ('{"orbit": {"zoom": -1}}', '"zoom": expected a number'),
                            ('{"size": [100000, 1]}', '"size": expected a whole number'),
                            ('{"scale": 100}', '"scale": expected a number from 0.0625 to 4'),
                            ('{"layer": "../x"}', '"layer": expected one of color'),
                            ('{"parameters": {"camera.fov": 1}}', "no such parameter"),
                            ('{"scene": "/etc/passwd"}', '"scene": no such key')):
            status, _, answer = self.ask("settings", "POST", body)
            self.assertEqual(status, 400, body)
            self.assertIn(words, answer.decode("utf-8"))
        for query in ("after=x", "after=-1", "viewer=" + "v" * 65):
            self.assertEqual(self.ask(f"state?{query}")[0], 400, query)
        self.assertEqual(self.ask("image?mode=../wavefront")[0], 404)
        self.assertEqual(self.ask("save?mode=../wavefront&form=exr")[0], 404)

    def test_only_this_machine_hears_it(self):
        self.start()
        with self.assertRaises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.2", self.port), timeout=TIMEOUT_S)

    def test_noise(self):
        self.start()
        for text in ("\r\n\r\n", "GET\r\n\r\n", "X" * 9000 + "\r\n\r\n",
                     "GET / HTTP/1.1\r\nHost: " + "x" * 9000 + "\r\n\r\n"):
            self.assertIn(self.raw(text), (400, 403, 414), text[:20])
        self.assertEqual(self.ask("")[0], 200)


class SlowAndEndless(Program):
    """What does not end, or only after a long time, costs neither memory nor the page."""

    def connect(self):
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=TIMEOUT_S)
        self.addCleanup(connection.close)
        return connection

    def send(self, parts, most=1 << 26):
        """Sends until the server has had enough: (status, bytes that were sent)."""
        connection, sent = self.connect(), 0
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            for part in parts:
                connection.sendall(part)
                sent += len(part)
                if sent > most:
                    break
        reply = b""
        with contextlib.suppress(ConnectionResetError):
            while part := connection.recv(65536):
                reply += part
        match = re.match(rb"HTTP/1.1 (\d+) ", reply)
        return int(match[1]) if match else None, sent, reply

    def memory_mb(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii")
        return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024

    def test_requests_without_an_end(self):
        self.start()
        before = self.memory_mb()
        head = f"POST /{self.token}/settings HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n".encode()
        for first, part, expected in (
                (b"GET / HTTP/1.1\r\n", b"A: " + b"x" * 7000 + b"\r\n", 431),
                (b"GET / HTTP/1.1\r\n", b"a:b\r\n", 431),
                (b"GET / HTTP/1.1\r\nA: ", b"x" * 8000, 431),
                (b"GET /", b"x" * 8000, 431),
                (b"GET / HTTP/1.1\r\n", b"\n", 400),
                (b"", b"\0" * 8000, 431),
                (head + b"Content-Length: 4096\r\n\r\n", b" " * 4096, 400),
                (head + b"Content-Length: 1000000000\r\n\r\n", b" " * 8000, 413),
                (head + b"Transfer-Encoding: chunked\r\n\r\n", b"8\r\nxxxxxxxx\r\n", 411),
                (head + b"Transfer-Encoding: chunked\r\n\r\n", b"1" * 8000, 411),
                (head + b"Content-Length: 1000000000\r\nTransfer-Encoding: x\r\n\r\n", b" ", 411)):
            def parts(first=first, part=part):
                yield first
                while True:
                    yield part
            status, sent, reply = self.send(parts())
            self.assertIn(status, (expected, None), first + part[:10])
            self.assertLess(sent, 1 << 24, first + part[:10])
            if status == 431:
                self.assertIn(b"Content-Security-Policy: default-src 'none'", reply)
                self.assertIn(b"expected at most 16384 bytes and 100 lines", reply)
        self.assertLess(self.memory_mb() - before, 20)
        self.assertEqual(self.ask("")[0], 200)

    def test_both_sides_of_the_limits(self):
        self.start()
        first = f"GET /{self.token}/ HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n".encode()
        for lines, expected in ((97, 200), (98, 431)):  # with two before and an empty one
            self.assertEqual(self.send([first + b"a:b\r\n" * lines + b"\r\n"])[0], expected, lines)
        first += b"b:" + b"x" * 8000 + b"\r\na:"
        room = 16384 - len(first) - len(b"\r\nc:\r\n\r\n") - 4000
        for more, expected in ((0, 200), (1, 431)):
            head = first + b"x" * 4000 + b"\r\nc:" + b"x" * (room + more) + b"\r\n\r\n"
            self.assertEqual(len(head), 16384 + more)
            self.assertEqual(self.send([head])[0], expected, more)

    def test_a_range_is_ignored(self):
        self.start()
        whole = len(self.ask("")[2])
        for value in ("bytes=0-9", "bytes=5-", "bytes=-3", "bytes=0-1,4-5", "bytes=999999-"):
            status, headers, body = self.ask("", headers={"Range": value})
            self.assertEqual(status, 200, value)
            self.assertIsNone(headers["Content-Range"], value)
            self.assertLess(abs(len(body) - whole), 10, value)
            self.assertEqual(self.request("GET", "/", headers={"Range": value})[0], 404)

    def slow(self, count):
        """Connections that send a byte every half second, without an end."""
        connections = [self.connect() for _ in range(count)]
        for connection in connections:
            connection.sendall(b"GET / HTTP/1.1\r\nX: ")
        over = threading.Event()

        def drip():
            while not over.wait(0.5):
                for connection in connections:
                    with contextlib.suppress(OSError):
                        connection.send(b"a")
        thread = threading.Thread(target=drip)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(over.set)
        return connections

    def test_slow_connections_leave_room_for_the_page(self):
        self.start()
        slow = self.slow(100)
        begin = time.monotonic()
        for _ in range(5):
            self.assertEqual(self.ask("")[0], 200)
        self.assertLess(time.monotonic() - begin, 4)
        replies = []
        for connection in slow:
            with contextlib.suppress(ConnectionResetError):
                replies.append(connection.recv(4096))
        self.assertLess(time.monotonic() - begin, 12, "a request has five seconds")
        self.assertTrue(any(reply.startswith(b"HTTP/1.1 408 ") for reply in replies))
        idle = self.connect()
        self.assertEqual(idle.recv(10), b"", "closed without a word")

    def test_a_signal_ends_it_within_a_second(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            process = self.start()
            self.slow(40)
            self.connect()  # idle, as browsers keep one
            waiter = threading.Thread(target=lambda: self.ask("state?after=1"))
            waiter.start()
            time.sleep(0.5)
            begin = time.monotonic()
            process.send_signal(number)
            self.assertEqual(process.wait(timeout=TIMEOUT_S), code)
            self.assertLess(time.monotonic() - begin, 2)  # a second, on a busy machine
            waiter.join()


class CommandLine(Program):
    def assert_refused(self, *arguments, words):
        run = subprocess.run([PTEXP, "view", *arguments], capture_output=True, text=True,
                             check=False, timeout=TIMEOUT_S)
        self.assertEqual((run.returncode, run.stdout), (2, ""), run.stderr)
        self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
        for word in words:
            self.assertIn(word, run.stderr)

    def test_what_cannot_be_shown(self):
        self.start()  # skips without HTTP
        self.assert_refused(words=["ptexp view SCENE"])
        self.assert_refused("no-such", "--port", "0", words=["no-such"])
        self.assert_refused("absent.xml", "--port", "0", words=["absent.xml"])
        self.assert_refused("cornell", "--port", "65536", words=["--port 65536"])
        self.assert_refused("cornell", "--integrator", "mlt", words=["--integrator mlt"])
        for option, value in (("output", "a.png"), ("scene", "x"), ("repeat", "2"),
                              ("checkpoint", "a.exr"), ("time-limit", "3"), ("aov", "depth")):
            self.assert_refused("cornell", f"--{option}", value,
                                words=[f"--{option}: has no effect together with view"])
        self.assert_refused("cornell", "--spp", "0", words=["--spp 0"])

    def test_a_busy_port(self):
        self.start()
        self.assert_refused("cornell", "--port", str(self.port), words=[f"--port {self.port}"])

    def test_ends_by_a_signal_even_while_one_waits(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            process = self.start()
            version = self.state()["version"]
            waiter = threading.Thread(target=self.state, kwargs={"after": version})
            waiter.start()
            time.sleep(0.3)  # that it is heard before
            process.send_signal(number)
            self.assertEqual(process.wait(timeout=TIMEOUT_S), code)
            waiter.join()
            self.assertIn("interrupted", process.stderr.read())

    def test_quiet_prints_the_address_alone(self):
        process = self.start("--quiet")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.stdout.read(), "")


class Browser:
    """Headless Chromium, by its protocol over two pipes."""

    def __init__(self, path, folder):
        to_child, self.output = os.pipe()
        self.input, from_child = os.pipe()
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_child, from_child)]
        os.close(to_child)
        os.close(from_child)
        script = f'exec "$0" "$@" 3<&{ends[0]} 4>&{ends[1]} {ends[0]}<&- {ends[1]}>&-'
        self.process = subprocess.Popen(
            ["bash", "-c", script, path, "--headless", "--no-sandbox", "--disable-gpu",
             "--no-first-run", "--remote-debugging-pipe", f"--user-data-dir={folder}/profile",
             "--window-size=900,700"],
            pass_fds=ends, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in ends:
            os.close(end)
        self.replies, self.problems, self.count = queue.Queue(), [], 0
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        rest = b""
        while True:
            part = os.read(self.input, 1 << 16)
            if not part:
                return
            *messages, rest = (rest + part).split(b"\0")
            for message in map(json.loads, messages):
                if "id" in message:
                    self.replies.put(message)
                elif (message["method"] == "Runtime.exceptionThrown" or
                      message["params"].get("entry", {}).get("level") == "error"):
                    self.problems.append(json.dumps(message["params"]))

    def call(self, method, session=None, **params):
        self.count += 1
        message = {"id": self.count, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self.output, json.dumps(message).encode() + b"\0")
        while True:
            reply = self.replies.get(timeout=TIMEOUT_S)
            if reply["id"] == self.count:
                if "error" in reply:
                    raise AssertionError(f"{method}: {reply['error']}")
                return reply["result"]

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.output)

    def open(self, url):
        return Tab(self, url)


class Tab:
    def __init__(self, browser, url):
        self.browser = browser
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target,
                                    flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setFocusEmulationEnabled", enabled=True)  # of all tabs at once
        self.call("Page.navigate", url=url)

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def value(self, expression):
        reply = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                          awaitPromise=True)
        if "exceptionDetails" in reply:
            return None  # the page is not there yet
        return reply["result"].get("value")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, begin, end, steps=5):
        left = {"button": "left", "buttons": 1}
        self.mouse("mousePressed", *begin, clickCount=1, **left)
        for i in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * i / steps for a, b in zip(begin, end)), **left)
        self.mouse("mouseReleased", *end, button="left", clickCount=1)

    def set_width(self, width, height=900):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=width < 500)

    def picture(self, name):
        """Kept where PTEXP_SCREENSHOTS says so."""
        folder = os.environ.get("PTEXP_SCREENSHOTS")
        if not folder:
            return
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        Path(folder, f"{name}.png").write_bytes(base64.b64decode(shot))

    def click(self, element):
        """As a user does it, who first scrolls there."""
        self.value(f'document.querySelector("{element}").scrollIntoView({{block: "center"}})')
        x, y = self.middle(element)
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y, button="left", clickCount=1)

    def choose(self, element, value):
        self.value(f'(() => {{ const e = document.querySelector("{element}"); e.value = "{value}"; '
                   'for (const kind of ["input", "change"]) e.dispatchEvent(new Event(kind)); })()')

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key,
                      text=key if len(key) == 1 else "")

    def text(self, element):
        return self.value(f'document.querySelector("{element}").innerText') or ""

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def middle(self, element="canvas"):
        return self.value(f'(() => {{ const b = document.querySelector("{element}")'
                          '.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2];'
                          '})()')

    def samples(self):
        """The samples of each mode, as the page shows them."""
        return self.value('[...document.querySelectorAll("#figures tr")]'
                          '.map((row) => Number(row.cells[1].textContent))') or []

    def pixels(self):
        """(width, height, RGB) of what the canvas shows."""
        found = self.value('(() => { const c = document.querySelector("canvas"); return [c.width, '
                           'c.height, [...c.getContext("2d").getImageData(0, 0, c.width, c.height)'
                           '.data].filter((_, i) => i % 4 < 3)]; })()')
        return found[0], found[1], bytes(found[2])


class InBrowser(Program):
    def setUp(self):
        path = shutil.which("chromium") or shutil.which("google-chrome")
        if not path:
            if os.environ.get("PTEXP_NEEDS_CHROMIUM") == "1":
                self.fail("not installed: chromium")
            self.skipTest("not installed: chromium")
        folder = tempfile.TemporaryDirectory(prefix="ptexp-view-", ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.browser = Browser(path, folder.name)
        self.addCleanup(self.browser.close)

    def open(self):
        return self.browser.open(f"http://127.0.0.1:{self.port}/{self.token}/")

    def peek(self):
        """The state, by somebody who does not count as a viewer."""
        return json.loads(self.ask("state")[2])

    def assert_no_problems(self):
        self.assertEqual(self.browser.problems, [])

    def test_the_image_appears_and_an_orbit_begins_anew(self):
        self.start(spp="16")
        tab = self.open()
        wait_for(lambda: tab.samples() == [16], "the last sample on the page")
        rest = self.rendered("--spp", "16")
        wait_for(lambda: tab.pixels() == rest, "the image on the page")
        x, y = tab.middle()
        tab.drag((x, y), (x + 10, y + 4))
        orbit = wait_for(lambda: (o := self.peek()["orbit"])["yaw"] != 0 and o, "another orbit")
        self.assertLess(orbit["yaw"], 0, "the scene follows the mouse, the camera goes left")
        self.assertGreater(orbit["pitch"], 0)
        wait_for(lambda: self.peek()["status"] == "done" and tab.samples() == [16], "the new image")
        wait_for(lambda: tab.pixels() == self.image(), "the new image on the page")
        self.assertNotEqual(tab.pixels(), rest)
        tab.mouse("mouseWheel", x, y, deltaX=0, deltaY=200)
        wait_for(lambda: self.peek()["orbit"]["zoom"] > 1, "another distance")
        for count in (1, 2):
            for kind in ("mousePressed", "mouseReleased"):
                tab.mouse(kind, x, y, button="left", clickCount=count)
        wait_for(lambda: self.peek()["orbit"] == {"yaw": 0, "pitch": 0, "zoom": 1}, "the reset")
        wait_for(lambda: tab.pixels() == rest, "the first image")
        self.assert_no_problems()

    def test_a_drag_shows_its_images_and_begins_anew(self):
        self.start()
        tab = self.open()
        wait_for(lambda: max(tab.samples(), default=0) > 50, "many samples")
        x, y = tab.middle()
        tab.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        images = set()

        def move():
            move.to = move.to % 16 + 2
            tab.mouse("mouseMoved", x + move.to, y, button="left", buttons=1)
            time.sleep(0.1)
            images.add(self.image())
            return len(images) > 4
        move.to = 0
        wait_for(move, "images while the camera moves")  # the button stays down
        turned = self.peek()["orbit"]["yaw"]
        self.assertLess(turned, 0)
        tab.mouse("mouseReleased", x + move.to, y, button="left", clickCount=1)
        self.assertEqual(self.peek()["orbit"]["yaw"], turned)
        self.assert_no_problems()

    def test_modes_side_by_side(self):
        self.start(spp="4")
        tab = self.open()
        wait_for(lambda: tab.samples() == [4], "the image")
        self.assertTrue(tab.value('document.querySelector("#divider").hidden'))
        tab.choose("#mode", "split")
        wait_for(lambda: tab.samples() == [4, 4], "both modes")
        wait_for(lambda: not tab.value('document.querySelector("#divider").hidden'), "the divider")
        expected = self.rendered("--spp", "4")
        wait_for(lambda: tab.pixels() == expected, "both halves of the same image")
        x, y = tab.middle("#divider")
        tab.drag((x, y), (x - 8, y))
        wait_for(lambda: int(tab.value('document.querySelector("#divider").ariaValueNow')) < 50,
                 "the divider elsewhere")
        self.assertEqual(tab.pixels(), expected)
        self.assertEqual(self.peek()["orbit"]["yaw"], 0)
        self.assert_no_problems()

    def test_two_viewers_see_the_same_and_the_last_closed_tab_ends_the_work(self):
        self.start()
        first, second = self.open(), self.open()
        for tab in (first, second):
            wait_for(lambda tab=tab: max(tab.samples(), default=0) > 4, "samples")
        first.choose("#exposure", 2)
        wait_for(lambda: second.value('document.querySelector("#exposure").value') == "2",
                 "the other one's exposure")
        first.close()
        samples = second.samples()[0]
        wait_for(lambda: second.samples()[0] > samples, "more samples for the other one")
        self.assert_works()
        second.close()
        self.assert_idle()
        self.assertEqual(self.peek()["status"], "idle")
        third = self.open()
        wait_for(lambda: max(third.samples(), default=0) > samples, "the render to go on")
        self.assert_no_problems()

    def test_keys_pause_show_layers_and_help(self):
        self.start()
        tab = self.open()
        wait_for(lambda: max(tab.samples(), default=0) > 0, "samples")
        tab.key(" ")
        wait_for(lambda: self.peek()["paused"], "the pause")
        wait_for(lambda: tab.text("#pause") == "go on" and "paused" in tab.text("#status"),
                 "the pause on the page")
        tab.click("#pause")
        wait_for(lambda: not self.peek()["paused"], "its end")
        tab.key("l")
        wait_for(lambda: self.peek()["layer"] == "albedo", "the next layer")
        for key, value in (("[", -0.5), ("]", 0)):
            tab.key(key)
            wait_for(lambda value=value: self.peek()["exposure"] == value, "the exposure")
        tab.key("t")
        wait_for(lambda: self.peek()["curve"] == "neutral", "the next curve")
        tab.key("ArrowLeft")
        wait_for(lambda: self.peek()["orbit"]["yaw"] == -5, "the camera")
        tab.key("r")
        wait_for(lambda: self.peek()["orbit"]["yaw"] == 0, "the camera at rest")
        tab.choose("#layer", "rays")
        wait_for(lambda: "rays per sample" in tab.text("#legend"), "the scale of the heat map")
        tab.set_width(1280)
        tab.picture("rays-1280")
        tab.key("?")
        self.assertTrue(tab.value('document.querySelector("#help").open'))
        tab.picture("help-1280")
        self.assert_no_problems()

    def test_what_is_copied_and_saved(self):
        self.start(spp="4")
        tab = self.open()
        wait_for(lambda: tab.samples() == [4], "the image")
        self.browser.call("Browser.grantPermissions",
                          permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        for button, form in (("#copy_options", "options"), ("#copy_xml", "xml")):
            tab.click(button)
            expected = self.peek()["camera"][form]
            wait_for(lambda: "copied" in tab.text("#copy_note"), "the note", 20)
            self.assertEqual(tab.value('document.querySelector("#copied").textContent'), expected)
            self.assertEqual(tab.value("navigator.clipboard.readText()"), expected)
        with tempfile.TemporaryDirectory() as folder:
            self.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
            for button, name in (("#png", "cornell.png"), ("#exr", "cornell.exr")):
                tab.click(button)
                wait_for((Path(folder) / name).exists, name)
            self.assertEqual(read_png((Path(folder) / "cornell.png").read_bytes()), self.image())
            self.assertEqual((Path(folder) / "cornell.exr").read_bytes()[:4], b"\x76\x2f\x31\x01")
        self.assert_no_problems()

    def test_parameters_in_their_panel(self):
        self.start(spp="4")
        tab = self.open()
        wait_for(lambda: tab.samples() == [4], "the image")
        rest = self.image()
        wait_for(lambda: tab.pixels() == rest, "the image on the page")
        tab.click("#parameters summary")
        rows = wait_for(lambda: tab.value('document.querySelectorAll("#list .row").length'),
                        "the parameters")
        names = [one["name"] for one in json.loads(self.ask("parameters")[2])]
        self.assertEqual(rows, len(names))
        tab.choose("#list input[type=number]", 0.125)
        wait_for(lambda: self.peek()["parameters"].get(names[0], [0])[0] == 0.125, "the edit")
        wait_for(lambda: self.peek()["status"] == "done" and tab.pixels() == self.image() != rest,
                 "another image")
        wait_for(lambda: tab.value('document.querySelectorAll("#list .edited").length') == 1,
                 "what is edited")
        tab.choose("#list input[type=color]", "#ff0000")
        wait_for(lambda: self.peek()["parameters"].get(names[0]) == [1, 0, 0], "red")
        tab.set_width(1280, 1100)
        tab.picture("parameters-1280")
        tab.choose("#filter", "sky")
        shown = 'document.querySelectorAll("#list section:not([hidden])").length'
        self.assertEqual(tab.value(shown), 1)
        tab.click("#as_loaded")
        wait_for(lambda: self.peek()["parameters"] == {}, "the reset")
        wait_for(lambda: tab.pixels() == rest, "the first image")
        self.assert_no_problems()

    def test_the_time_of_what_moves(self):
        scene = """Camera "perspective" "float fov" 50 Film "rgb" "integer xresolution" 64 "integer yresolution" 48
            PixelFilter "box" WorldBegin LightSource "infinite" "rgb L" [0.5 0.5 0.5] Material "diffuse"
            AttributeBegin %s Shape "trianglemesh" "point3 P" [-1 -1 5 1 -1 5 0 1 5] "integer indices" [0 1 2] AttributeEnd"""
        with tempfile.TemporaryDirectory() as folder:
            def image(transforms):
                file = Path(folder) / "scene.pbrt"
                file.write_text(scene % transforms, encoding="utf-8")
                subprocess.run([PTEXP, "--scene", file, *SMALL, "--spp", "4", "-o", f"{folder}/a.png"],
                               check=True, capture_output=True, timeout=TIMEOUT_S)
                return read_png(Path(folder, "a.png").read_bytes())
            halfway, end = image("Translate 0.5 0 0"), image("Translate 1 0 0")
            blurred = image("ActiveTransform EndTime Translate 1 0 0 ActiveTransform All")
            self.assertEqual(len({halfway, end, blurred}), 3)
            self.start(spp="4", scene=f"{folder}/scene.pbrt")
            tab = self.open()
            wait_for(lambda: tab.samples() == [4], "the last sample on the page")
            wait_for(lambda: tab.pixels() == blurred, "the blurred image")
            self.assertFalse(tab.value('document.querySelector("#motion").hidden'))
            for time_s, expected in ((0.5, halfway), (1, end)):
                tab.choose("#time", time_s)
                wait_for(lambda: self.peek()["time"] == time_s and tab.pixels() == expected, f"the image at {time_s} s")
            self.assertEqual(tab.text("#seconds"), "1.00 s")
            tab.picture("time-1280")
            tab.click("#blur")
            wait_for(lambda: self.peek()["time"] is None and tab.pixels() == blurred, "the blurred image again")
        self.assert_no_problems()

    def test_a_scene_that_stands_has_no_time(self):
        self.start(spp="1")
        tab = self.open()
        wait_for(lambda: tab.samples() == [1], "the image")
        self.assertTrue(tab.value('document.querySelector("#motion").hidden'))
        status, _, body = self.ask("settings", "POST", json.dumps({"time": 0.5}))
        self.assertEqual((status, body), (400, b'"time": nothing moves in this scene\n'))

    def test_figures_of_the_divided_view(self):
        self.start("--width", "160", "--height", "120")
        tab = self.open()
        wait_for(lambda: max(tab.samples(), default=0) > 0, "samples")
        tab.choose("#mode", "split")
        wait_for(lambda: (self.peek()["ratio"] or {}).get("rounds", 0) > 5, "the ratio")
        wait_for(lambda: "95 %" in tab.text("#ratio"), "the ratio on the page")
        ratio = float(re.search(r"takes ([0-9.]+) times", tab.text("#ratio"))[1])
        self.assertLess(abs(ratio - self.peek()["ratio"]["value"]), 0.2 * ratio)
        for word in ("wavefront: ", "megakernel: ", "ms per sample", "shade_surface"):
            self.assertIn(word, tab.text("#stages"))
        self.assertEqual(tab.value('document.querySelectorAll("#stages .bar").length'), 2)
        widths = tab.value('[...document.querySelectorAll("#stages .bar")]'
                           '.map((bar) => parseFloat(bar.style.width))')
        self.assertEqual(max(widths), 100)
        tab.choose("#target", 0.001)
        tab.choose("#target", 0.002)
        self.assertRegex(tab.text("#needs"), r"needs about \d+ samples: [0-9.]+ (s|min|h|days) more")
        tab.set_width(1280)
        tab.picture("split-1280")
        tab.choose("#mode", "auto")
        wait_for(lambda: tab.text("#why").startswith("wavefront: the CPU"), "why that mode")
        tab.picture("auto-1280")
        self.assert_no_problems()

    def test_a_telephone(self):
        """Nothing is wider than the screen, and controls are as large as a finger."""
        self.start("--width", "300", "--height", "150", spp="8")
        tab = self.open()
        tab.set_width(390, 844)
        wait_for(lambda: tab.samples() == [8], "the image")
        tab.click("#parameters summary")
        wait_for(lambda: tab.value('document.querySelectorAll("#list .row").length'), "parameters")
        tab.click("#copy_xml")
        tab.choose("#mode", "split")
        wait_for(lambda: tab.samples() == [8, 8], "both modes")
        self.assertLessEqual(tab.value("document.scrollingElement.scrollWidth"), 390)
        self.assertGreater(tab.value('document.querySelector("canvas").clientWidth'), 350)
        inside = ('[...document.querySelectorAll("main *")].filter((e) => e.getClientRects()'
                  '.length && e.getBoundingClientRect().right > 391).map((e) => e.id || e.tagName)')
        self.assertEqual(tab.value(inside), [])
        small = ('[...document.querySelectorAll("button, select, .button")].filter((e) => '
                 'e.getClientRects().length && e.getBoundingClientRect().height < 32)'
                 '.map((e) => e.id)')
        self.assertEqual(tab.value(small), [])
        tab.picture("telephone-390")
        tab.value("scrollTo(0, 0)")
        x, y = tab.middle()
        for kind, apart in (("Start", 20), ("Move", 30), ("Move", 40), ("End", None)):
            fingers = [] if apart is None else [{"x": x + side * apart, "y": y, "id": side + 1}
                                                for side in (-1, 1)]
            tab.call("Input.dispatchTouchEvent", type=f"touch{kind}", touchPoints=fingers)
        wait_for(lambda: abs(self.peek()["orbit"]["zoom"] - 0.5) < 0.01, "half the distance")
        self.assertEqual(self.peek()["orbit"]["yaw"], 0)
        self.assert_no_problems()

    def test_the_page_says_when_the_program_has_ended(self):
        self.start()
        tab = self.open()
        wait_for(lambda: max(tab.samples(), default=0) > 0, "samples")
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(timeout=TIMEOUT_S), 130)
        wait_for(lambda: "has ended" in (tab.value('document.querySelector("#status").textContent')
                                         or ""), "the end on the page")


if __name__ == "__main__":
    unittest.main()
