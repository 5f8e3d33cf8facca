#!/usr/bin/env python3
"""Prints the coefficients of src/common/material/microfacet_loss.h.

The energy that microfacets of reflectance 1 lose by single scattering is integrated for many
roughnesses and cosines and fitted by polynomials (microfacet_loss.h). Prints the largest errors.

Usage: scripts/fit_microfacet_loss.py. Takes a minute; needs numpy.
"""
import math
import sys

import numpy as np

POWERS, ROUGHNESSES, AVERAGES = 7, 6, 4  # terms, as in MicrofacetLossFit
erf = np.vectorize(math.erf)


def visible_over_cosine(w, slopes, is_beckmann):
    """Smith's G1 over the cosine w; slopes: (alpha sine)^2."""
    if not is_beckmann:
        return 2 / (w + np.sqrt(w * w + slopes))
    root = np.sqrt(slopes)
    a = w / np.maximum(root, 1e-20)
    return 2 / np.maximum(w * (1 + erf(a)) + root * np.exp(-a * a) / math.sqrt(math.pi), 1e-30)


def loss(cosine, alpha, is_beckmann, rings=400, sectors=240):
    """1 - E: by the slopes of the facets, evenly by their distribution."""
    s = (np.arange(rings) + 0.5) / rings
    weight = 2 * s / rings  # u = 1 - s^2 has no steep end
    radius = alpha * (np.sqrt(-2 * np.log(s)) if is_beckmann else np.sqrt(1 - s * s) / s)
    phi = (np.arange(sectors) + 0.5) / sectors * 2 * np.pi
    x, y = radius[:, None] * np.cos(phi), radius[:, None] * np.sin(phi)
    sine = math.sqrt(1 - cosine * cosine)
    m_z = 1 / np.sqrt(1 + x * x + y * y)
    dot = (cosine + x * sine) * m_z
    i_z = 2 * dot * m_z - cosine
    seen = (dot > 0) & (i_z > 0)
    i_z = np.where(seen, np.minimum(i_z, 1), 1)
    shown = i_z * visible_over_cosine(i_z, alpha * alpha * (1 - i_z * i_z), is_beckmann)
    values = np.where(seen, dot / m_z * shown, 0)
    masked = visible_over_cosine(np.array([cosine]), (alpha * sine) ** 2, is_beckmann)[0]
    return 1 - masked * float(values.mean(1) @ weight)


def minimax(terms, values, rounds):
    """Coefficients of the least largest error, nearly (Lawson 1961)."""
    weight, best = np.ones(len(values)), None
    for _ in range(rounds):
        root = np.sqrt(weight)
        c = np.linalg.lstsq(terms * root[:, None], values * root, rcond=None)[0]
        error = np.abs(terms @ c - values)
        if best is None or error.max() < best[0]:
            best = error.max(), c
        weight *= error / error.max() + 1e-3
        weight /= weight.sum()
    return best


def terms_of(cosine, alpha, is_beckmann):
    k = 16 * alpha * alpha
    t = cosine / np.sqrt(cosine * cosine + k)
    y = alpha * alpha if is_beckmann else alpha
    return np.stack([(1 - t * t) * t**i * y**j for i in range(POWERS) for j in range(ROUGHNESSES)],
                    1)


def fit_loss(is_beckmann):
    cosines, alphas = [], []
    for alpha in [0.002, 0.01, 0.02, 0.035, *np.linspace(0.05, 1, 26)]:
        t = np.linspace(0, 1 / (1 + alpha), 33)
        some = np.unique(np.clip(np.append(t * alpha / (1 - t), np.linspace(0, 1, 17)), 1e-5, 1))
        cosines.extend(some)
        alphas.extend([alpha] * len(some))
    losses = np.array([loss(m, a, is_beckmann) for m, a in zip(cosines, alphas)])
    return minimax(terms_of(np.array(cosines), np.array(alphas), is_beckmann), losses, 100)


def fit_average(coefficients, is_beckmann):
    """The average of the fitted loss; its error counts as much as it changes the albedo at most."""
    x, weight = np.polynomial.legendre.leggauss(16)
    alphas = np.concatenate([np.geomspace(1e-4, 0.05, 60), np.linspace(0.05, 1, 60)])
    averages, largest = [], []
    for alpha in alphas:
        ends = np.append(0, np.geomspace(alpha / 20, 1, 24))
        low, width = ends[:-1, None], np.diff(ends)[:, None]
        cosine = (low + width * (x + 1) / 2).ravel()
        values = terms_of(cosine, np.full_like(cosine, alpha), is_beckmann) @ coefficients
        values = np.maximum(values, 0)
        averages.append(float((values * 2 * cosine) @ (width * weight / 2).ravel()))
        largest.append(values.max())
    averages, largest = np.array(averages), np.array(largest)
    k = 16 * alphas * alphas
    terms = [k * np.log1p(1 / k) * alphas**i for i in range(AVERAGES)]
    terms += [k * alphas**i for i in range(AVERAGES)]
    return minimax(np.stack(terms, 1) * (largest / averages)[:, None], largest, 60)


def text(numbers):
    return "{" + ", ".join(f"{x:.8g}f" if "." in f"{x:.8g}" or "e" in f"{x:.8g}"
                           else f"{x:.8g}.0f" for x in numbers) + "}"


def main():
    for name in ("ggx", "beckmann"):
        error, c = fit_loss(name == "beckmann")
        average_error, d = fit_average(c, name == "beckmann")
        print(f"{name}: {error:.5f}, by the average {average_error:.5f}", file=sys.stderr)
        rows = ", ".join(text(row) for row in c.reshape(POWERS, ROUGHNESSES))
        print(f"PT_HD constexpr MicrofacetLossFit {name}_loss_fit() {{")
        print(f"return {{{{{rows}}}, {text(d[:AVERAGES])}, {text(d[AVERAGES:])}}};\n}}\n")


if __name__ == "__main__":
    main()
