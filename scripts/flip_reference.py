#!/usr/bin/env python3
"""Prints the values of tests/image/test_flip.cpp, as the package flip-evaluator finds them.

Usage: flip_reference.py      needs the Python packages flip-evaluator and numpy
"""
import flip_evaluator
import numpy as np

WIDTH, HEIGHT = 40, 30
PLACES = [(0, 0), (7, 3), (20, 15), (31, 22), (39, 29), (12, 25)]


def images():
    """Linear; the same formulas stand in the test."""
    y, x, c = np.meshgrid(np.arange(HEIGHT), np.arange(WIDTH), np.arange(3), indexing="ij")
    reference = 0.5 + 0.4 * np.sin(0.3 * x + 0.2 * y * (c + 1))
    reference = np.where((x > 10) & (x < 25) & (y > 8), 0.1 + 0.4 * c, reference)
    test = np.where((x + y) % 7 == 0, 0.7 * reference, reference)
    test = np.where(x > 30, 0.3 * test + 0.1, test)
    return test.astype(np.float32), reference.astype(np.float32)


def to_srgb(c):
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055).astype(np.float32)


def show(name, test, reference, kind):
    errors, mean, _ = flip_evaluator.evaluate(reference, test, kind, applyMagma=False)
    values = ", ".join(f"{errors[y, x, 0]:.6f}" for x, y in PLACES)
    print(f"{name}: mean {mean:.6f} at {PLACES}: {values}")


def main():
    test, reference = images()
    show("LDR", to_srgb(test), to_srgb(reference), "LDR")
    radiance = [np.exp(4 * image - 2).astype(np.float32) for image in (test, reference)]
    show("HDR", *radiance, "HDR")


if __name__ == "__main__":
    main()
