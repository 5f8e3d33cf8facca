"""Reads the planted bugs of tests/mutants and writes them into a copy of the sources.

Each file tests/mutants/*.txt holds entries, apart by blank lines; lines that begin with # are
comments:

    [ID] FILE            below src/
    what bug it is, in one line
    tests: FILTER        optional: gtest's filter of the tests that should see it
    within: TEXT         optional: the surroundings of `before`, where it occurs more than once
    before: TEXT         as the source has it; white space and line breaks do not matter
    after: TEXT

`before` is an expression, or statements where it ends with `;` or `}`, which declare nothing that
is used after them. It must be there exactly once. The copy holds both and chooses at run time:
`PT_MUTANT(n) ? (after) : (before)`.
"""
import re
import zlib
from pathlib import Path

HEADER = "common/mutant.h"
CUDA_SUFFIXES = (".cu", ".cuh", "_cuda.cpp", "_cuda.h")
# Device code that tests run on emulated blocks (tests/support/emulated_gpu.h).
EMULATED = ("common/block_wavefront/block_wavefront.cuh", "common/block_wavefront/path_query.cuh",
            "common/device/cuda/counting_sort.cuh", "common/accel/trace_cuda/persistent_cwbvh.cuh")

# Host code reads the environment once. Device code has a variable in each translation unit, which
# the test program sets before its first test.
HEADER_TEXT = """// Made by scripts/mutants: which planted bug is on.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace pt {
inline std::uint32_t read_mutant() {
  const char* text = std::getenv("PTEXP_MUTANT");
  return text == nullptr ? 0 : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}
inline const std::uint32_t host_mutant = read_mutant();
}  // namespace pt

#ifdef __CUDACC__
#include <cuda_runtime.h>

#include <vector>

namespace pt {
inline std::vector<void (*)()>& device_mutant_setters() {
  static std::vector<void (*)()> all;
  return all;
}
namespace {
__device__ std::uint32_t device_mutant;
void set_device_mutant() {
  cudaMemcpyToSymbol(device_mutant, &host_mutant, sizeof host_mutant);
  cudaGetLastError();
}
[[maybe_unused]] const bool device_mutant_registered =
    (device_mutant_setters().push_back(set_device_mutant), true);
}  // namespace
}  // namespace pt
#endif

#ifdef __CUDA_ARCH__
#define PT_MUTANT(number) (pt::device_mutant == number)
#else
#define PT_MUTANT(number) (pt::host_mutant == number)
#endif
"""

SETTER_TEXT = """// Made by scripts/mutants: turns the planted bug on in every file's device code.
#include <gtest/gtest.h>

#include "common/mutant.h"

namespace {
class SetMutants : public testing::Environment {
 public:
  void SetUp() override {
    for (const auto set : pt::device_mutant_setters()) set();
  }
};
[[maybe_unused]] testing::Environment* const set_mutants =
    testing::AddGlobalTestEnvironment(new SetMutants);
}  // namespace
"""


class ListError(Exception):
    """An entry that cannot be read or does not apply; names its file and id."""


class Mutant:
    def __init__(self, source, id_, file):
        self.source, self.id, self.file = source, id_, file
        self.bug = self.tests = self.within = self.before = self.after = ""
        self.number = zlib.crc32(id_.encode()) | 1  # the same whatever else is in the list

    @property
    def is_device_only(self):
        """By its file, or by the tests that should see it."""
        return (self.file.endswith(CUDA_SUFFIXES) and self.file not in EMULATED) or (
            bool(self.tests) and all(name.startswith("Cuda") for name in self.tests.split(":")))

    def fail(self, message):
        raise ListError(f"{self.source}: [{self.id}] {self.file}: {message}")

    @property
    def is_statement(self):
        return self.before.rstrip().endswith((";", "}"))

    def text(self, before):
        if self.is_statement:
            return f"{{ if (PT_MUTANT({self.number}u)) {{ {self.after} }} else {{ {before} }} }}"
        return f"(PT_MUTANT({self.number}u) ? ({self.after}) : ({before}))"


def is_balanced(text):
    """Whether each bracket of code has its partner; those in literals do not count."""
    pairs, open_ = {")": "(", "]": "[", "}": "{"}, []
    for character in re.sub(r"\"(\\.|[^\"\\])*\"|'(\\.|[^'\\])'", "", text):
        if character in pairs.values():
            open_.append(character)
        elif character in pairs and (not open_ or open_.pop() != pairs[character]):
            return False
    return not open_


def is_expression(text):
    """False where something is missing or what begins is a statement; a compiler sees the rest."""
    begins = (r"(if|else|for|while|do|return|case|auto|const|constexpr|static|using)\b"
              r"|[{.,)?=<>|/%^]|&&|:[^:]")
    ends = r"((?<!\+)\+|(?<!-)-|[*/%&|^<=?:,.(\[{])$"
    return bool(text) and not re.match(begins, text) and not re.search(ends, text)


def read_entry(source, lines):
    head = re.fullmatch(r"\[([\w-]+)\] (\S+)", lines[0])
    if not head or len(lines) < 4:
        raise ListError(f"{source}: '{lines[0]}': expected '[ID] FILE', a line on the bug, "
                        "'before:' and 'after:'")
    mutant = Mutant(source, head[1], head[2])
    mutant.bug = lines[1]
    for line in lines[2:]:
        key, colon, value = line.partition(":")
        if not colon or key not in ("tests", "within", "before", "after"):
            mutant.fail(f"'{line}': expected tests, within, before or after")
        setattr(mutant, key, value.strip())
    if not mutant.before:
        mutant.fail("no 'before'")
    for text in (mutant.before, mutant.after):
        if not is_balanced(text):
            mutant.fail(f"'{text}': expected whole expressions or statements, with both brackets")
        if not mutant.is_statement and not is_expression(text):
            mutant.fail(f"'{text}': expected an expression, or a statement with its ';'")
    if mutant.is_statement and re.match(r"(auto|const|constexpr|static|using)\b", mutant.before):
        mutant.fail(f"'{mutant.before}': expected what declares nothing, such as its value")
    return mutant


def read_mutants(folder):
    """All entries, in the order of the files' names."""
    mutants, seen = [], set()
    for path in sorted(Path(folder).glob("*.txt")):
        lines = [line.rstrip() for line in path.read_text().splitlines()
                 if not line.startswith("#")]
        for block in re.split(r"\n{2,}", "\n".join(lines).strip("\n")):
            if not block.strip():
                continue
            mutant = read_entry(path.name, block.strip("\n").split("\n"))
            if mutant.id in seen or mutant.number in seen:
                mutant.fail("the id is taken")
            seen |= {mutant.id, mutant.number}
            mutants.append(mutant)
    return mutants


def pattern_of(text):
    """Matches `text` with any white space between its words and around its punctuation."""
    return r"\s*".join(re.escape(token) for token in re.findall(r"\w+|[^\w\s]", text))


def place_of(mutant, text):
    """Where `before` stands in the source, as (begin, end)."""
    begin, end = 0, len(text)
    for what in filter(None, (mutant.within, mutant.before)):
        found = [m.span() for m in re.finditer(pattern_of(what), text[begin:end])]
        if len(found) != 1:
            mutant.fail(f"'{what}' is there {len(found)} times, expected once")
        begin, end = begin + found[0][0], begin + found[0][1]
    ahead = re.sub(r"//[^\n]*", "", text[:begin]).rstrip()
    if mutant.is_statement and not re.search(r"([;{}):]|\belse|^)$", ahead):
        mutant.fail(f"'{mutant.before}': expected a whole statement, or an expression without ';'")
    return begin, end


def with_mutants(mutants, text):
    """One file's text with all of its mutants."""
    places = sorted(((place_of(m, text), m) for m in mutants), key=lambda p: (p[0], p[1].id))
    result, done, i = [], 0, 0
    while i < len(places):
        (begin, end), first = places[i]
        if begin < done:
            first.fail("overlaps with the entry before it in the file")
        body = text[begin:end]
        while i < len(places) and places[i][0] == (begin, end):  # several of one expression
            body = places[i][1].text(body)
            i += 1
        result += [text[done:begin], body]
        done = end
    result.append(text[done:])
    include = f'#include "{HEADER}"\n'
    joined = "".join(result)
    return (joined.replace("#pragma once\n", "#pragma once\n" + include, 1)
            if "#pragma once\n" in joined else include + joined)


def mutated_files(mutants, src):
    """{path below src: text} for every file that has mutants, and the header."""
    by_file = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    texts = {HEADER: HEADER_TEXT}
    for file, of_file in by_file.items():
        path = Path(src) / file
        if not path.is_file():
            of_file[0].fail("there is no such file")
        texts[file] = with_mutants(of_file, path.read_text())
    return texts
