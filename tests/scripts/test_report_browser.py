"""The page of scripts/report in headless Chromium: wide and narrow screens, and paper.

With PTEXP_NEEDS_CHROMIUM=1 a missing Chromium or pdfinfo is an error and not a skip."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MOST_PAGES = 30
# Print styles are applied to the screen, at the width of A4 less its margins, to see what is cut.
PROBE = """<script>addEventListener("load", () => {
  const root = document.documentElement;
  const far = [...document.querySelectorAll(".scroll")].filter((box) =>
    box.tabIndex !== 0 || !box.getAttribute("aria-label"));
  const cut = [...document.querySelectorAll(".scroll")].filter((box) =>
    box.offsetParent && box.scrollWidth > box.clientWidth + 1);
  document.title = `OVER ${root.scrollWidth - root.clientWidth} FAR ${far.length} CUT ${cut.length}`;
});</script></head>"""


class Browser(unittest.TestCase):
    def setUp(self):
        self.browser = shutil.which("chromium") or shutil.which("google-chrome")
        missing = [name for name, path in (("chromium", self.browser),
                                           ("pdfinfo", shutil.which("pdfinfo"))) if not path]
        if missing:
            text = f"not installed: {', '.join(missing)}"
            if os.environ.get("PTEXP_NEEDS_CHROMIUM") == "1":
                self.fail(text)
            self.skipTest(text)
        folder = tempfile.TemporaryDirectory(prefix="ptexp-browser-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.page = self.folder / "report.html"
        subprocess.run([sys.executable, ROOT / "scripts" / "report",
                        ROOT / "results" / "nvidia-h200", "-o", self.page], check=True,
                       capture_output=True)

    def run_browser(self, page, *options):
        return subprocess.run([self.browser, "--headless", "--no-sandbox", "--disable-gpu",
                               f"--user-data-dir={self.folder}/profile", *options, page.as_uri()],
                              check=True, capture_output=True, text=True, timeout=120).stdout

    def probe(self, width, print_media=False):
        """(overflow of the document, boxes without focus or name, tables wider than their box)"""
        text = self.page.read_text(encoding="utf-8")
        if print_media:
            text = text.replace("@media print", "@media all")
        probed = self.folder / "probed.html"
        probed.write_text(text.replace("</head>", PROBE, 1), encoding="utf-8")
        shown = self.run_browser(probed, f"--window-size={width},900", "--dump-dom")
        found = re.search(r"<title>OVER (-?\d+) FAR (\d+) CUT (\d+)</title>", shown)
        self.assertTrue(found, "the page's script did not run")
        return tuple(map(int, found.groups()))

    def test_screens(self):
        for width in (1280, 500):
            over, far, _ = self.probe(width)
            self.assertEqual((over, far), (0, 0), f"{width} pixels")

    def test_no_table_is_cut_on_paper(self):
        self.assertEqual(self.probe(703, print_media=True)[2], 0)  # 186 mm

    def test_paper_is_thrifty(self):
        pdf = self.folder / "report.pdf"
        self.run_browser(self.page, f"--print-to-pdf={pdf}", "--no-pdf-header-footer")
        facts = subprocess.run(["pdfinfo", pdf], check=True, capture_output=True, text=True).stdout
        self.assertLessEqual(int(re.search(r"Pages:\s+(\d+)", facts)[1]), MOST_PAGES)


if __name__ == "__main__":
    unittest.main()
