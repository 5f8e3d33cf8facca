"""The notebook examples/tour.ipynb runs from its first cell to its last."""
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


class Notebook(unittest.TestCase):
    def test_tour(self):
        os.environ["PYTHONPATH"] = os.environ.get("PTEXP_PYTHON_PATH", "")  # of the kernel
        notebook = nbformat.read(ROOT / "examples" / "tour.ipynb", as_version=4)
        nbformat.validate(notebook)
        NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        pictures = sum("image/png" in output.get("data", {}) for output in outputs)
        self.assertGreaterEqual(pictures, 5)
        text = "".join(output.get("text", "") for output in outputs)
        self.assertRegex(text, r"of a warp's lanes \d+ % have work")
        self.assertRegex(text, r"million rays a second")


if __name__ == "__main__":
    unittest.main()
