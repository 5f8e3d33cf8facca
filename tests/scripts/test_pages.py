"""README.md, docs/ and results/README.md: short, each begins with its use, and links lead somewhere."""
import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "results" / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
MADE_BY_THE_SITE = {"options.md", "gallery.md", "report.md", "claims.md"}  # in docs/, by scripts/site
MOST_WORDS, MOST_TERMS = 22720, 25


def anchors(page):
    """Those of the headings, as GitHub and the site make them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    titles = re.findall(r"^#+ (.*)$", text, flags=re.M)
    plain = [re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", title).strip().lower() for title in titles]
    return {re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", title)) for title in plain}


def dead_links(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if re.match(r"\w+:", link) or target.parent == ROOT / "docs" and target.name in MADE_BY_THE_SITE:
            continue
        if not target.exists() or (anchor and target.suffix == ".md" and anchor not in anchors(target)):
            yield f"{page.relative_to(ROOT)}: {link}"


class Pages(unittest.TestCase):
    def test_all_together_are_short(self):
        words = {str(page.relative_to(ROOT)): len(page.read_text(encoding="utf-8").split())
                 for page in PAGES}
        self.assertLessEqual(sum(words.values()), MOST_WORDS, words)

    def test_each_begins_with_what_its_reader_can_do(self):
        for page in PAGES:
            paragraphs = page.read_text(encoding="utf-8").split("\n\n")[:3]
            self.assertTrue(any(text.startswith("After ") for text in paragraphs), page)

    def test_the_glossary_has_few_terms(self):
        _, table = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").split("---|---\n")
        self.assertLessEqual(len(table.strip().splitlines()), MOST_TERMS)

    def test_links_lead_somewhere(self):
        self.assertEqual([link for page in PAGES for link in dead_links(page)], [])

    def test_pages_that_sources_name_exist(self):
        found = subprocess.run(["git", "grep", "-hoE", r"\b(docs|results)/[a-z0-9_/-]+\.md"],
                               cwd=ROOT, capture_output=True, text=True, check=False).stdout
        for name in set(found.split()):
            if Path(name).name not in MADE_BY_THE_SITE:
                self.assertTrue((ROOT / name).exists(), name)


if __name__ == "__main__":
    unittest.main()
