"""The notebooks of examples/ are committed with what they show, and run from the first cell to the last."""
import os
import unittest

from ptexp_package import ROOT, ptexp  # noqa: F401, which skips where there is no module

try:
    import matplotlib  # noqa: F401
    import nbformat
    from nbclient import NotebookClient
except ImportError as error:
    if os.environ.get("PTEXP_NEEDS_PYTHON"):
        raise
    raise unittest.SkipTest(f"needs the packages of tests/python/requirements.txt: {error}")

MOST_BYTES = 400_000  # of a notebook with its pictures
COMPARISON = r"wavefront: [\d.]+ times as fast as the megakernel \[[\d.]+, [\d.]+\]: (faster|slower|same|ambiguous)"
EXPECTED = {  # at least so many pictures, and texts
    "tour": (4, [r"of a warp's lanes \d+ % have work", r"million rays a second", COMPARISON]),
    "which_mode": (4, [COMPARISON, r"On .*: the (wavefront|megakernel) is faster in \d of \d scenes"]),
}


def outputs_of(notebook):
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


class Notebook(unittest.TestCase):
    def read(self, name):
        notebook = nbformat.read(ROOT / "examples" / f"{name}.ipynb", as_version=4)
        nbformat.validate(notebook)
        return notebook

    def write(self, notebook, name):
        """As they are committed: without what differs from run to run."""
        notebook.metadata = nbformat.from_dict({"kernelspec": notebook.metadata["kernelspec"], "language_info": {"name": "python"}})
        for cell in notebook.cells:
            cell.metadata = nbformat.from_dict({})
        nbformat.write(notebook, ROOT / "examples" / f"{name}.ipynb")

    def check(self, notebook, name):
        pictures, texts = EXPECTED[name]
        outputs = outputs_of(notebook)
        self.assertGreaterEqual(sum("image/png" in output.get("data", {}) for output in outputs), pictures)
        text = "".join(output.get("text", "") + output.get("data", {}).get("text/plain", "") for output in outputs)
        for expected in texts:
            self.assertRegex(text, expected)
        self.assertEqual([output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"], [])

    def test_all_are_expected_here(self):
        self.assertEqual({path.stem for path in (ROOT / "examples").glob("*.ipynb")}, set(EXPECTED))

    def test_outputs_are_committed(self):
        for name in EXPECTED:
            with self.subTest(name):
                notebook = self.read(name)
                code = [cell for cell in notebook.cells if cell.cell_type == "code"]
                self.assertEqual([cell.execution_count for cell in code], list(range(1, len(code) + 1)))
                self.check(notebook, name)
                self.assertLess((ROOT / "examples" / f"{name}.ipynb").stat().st_size, MOST_BYTES)

    def test_they_run(self):
        os.environ["PYTHONPATH"] = os.environ.get("PTEXP_PYTHON_PATH", "")  # of the kernel
        for name in EXPECTED:
            with self.subTest(name):
                notebook = self.read(name)
                for cell in notebook.cells:
                    cell.update({"outputs": []} if cell.cell_type == "code" else {})
                NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
                self.check(notebook, name)
                if os.environ.get("PTEXP_WRITE_NOTEBOOKS"):
                    self.write(notebook, name)

    def test_progress_is_shown_below_a_cell(self):
        os.environ["PYTHONPATH"] = os.environ.get("PTEXP_PYTHON_PATH", "")
        source = "import ptexp\nptexp.render('cornell', width=64, height=64, spp=8, progress=True).shape"
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
        NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
        self.assertIn("100%|", "".join(output.get("text", "") for output in outputs_of(notebook)))


if __name__ == "__main__":
    unittest.main()
