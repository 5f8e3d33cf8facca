"""What a plot's numbers mean, in sentences. A difference is one only where intervals are apart."""
from .processes import about_processes, is_processes
from .scaling import about_scaling, is_scaling
from .tables import BASES, in_groups, interval, is_measured, number, style_of
from .words import (change, exponent, listed, plain, relation, show, unit_of, versus,
                    with_interval)

STEADY = 0.5  # y ~ x^p with at least this p, and y grows from x to x: a sentence on growth


def capital(text):
    return text[:1].upper() + text[1:]


def pairs_of(rows, column, label):
    found = ((row.get(label, ""), interval(row, column)) for row in rows
             if is_measured(row))
    return [(name, value) for name, value in found if value]


def ranking(pairs, unit, low_is_better=True, start=capital):
    """The best against the next that differs; those between do not."""
    pairs = sorted(pairs, key=lambda pair: pair[1].middle, reverse=not low_is_better)
    if len(pairs) < 2:
        return ""
    best, *others = pairs
    equal = [pair for pair in others if relation(best[1], pair[1]) == "overlap"]
    first = next((pair for pair in others if pair not in equal), None)
    parts = []
    if equal:
        parts.append(f"There is no significant difference between {best[0]} "
                     f"({with_interval(best[1], unit)}) and "
                     + listed(f"{name} ({with_interval(value, unit)})" for name, value in equal)
                     + ": their intervals overlap.")
    if first and low_is_better:
        parts.append(start(versus(best[0], best[1], first[0], first[1], unit)))
        if others[-1] != first:
            parts.append(f"The slowest, {others[-1][0]}, takes "
                         f"{show(others[-1][1].middle / best[1].middle)} times as long.")
    elif first:
        parts.append(f"{best[0]} is highest with {with_interval(best[1], unit)}, before "
                     f"{first[0]} with {with_interval(first[1], unit)}"
                     + ("." if first[1].known and best[1].known else
                        ", by values without a spread."))
    return " ".join(parts)


def about_default(pairs, unit):
    """Each row against the first one, the default or another of BASES."""
    (base, default), groups = pairs[0], {}
    for name, value in pairs[1:]:
        word, ratio = change(default, value)
        groups.setdefault(word, []).append((ratio, name))
    parts = [f"The row {base} takes {with_interval(default, unit)}."]
    for word, start in (("faster", "Faster: "), ("slower", "Slower: ")):
        if word in groups:
            ordered = sorted(groups[word], reverse=word == "slower")
            parts.append(start + listed(f"{name} (x{show(ratio)})" for ratio, name in ordered)
                         + " in time.")
    the = "the " * (base == BASES[0])
    for word, start in (("same", f"The same as {the}{base}: "), ("ambiguous", "Ambiguous: ")):
        if word in groups:
            parts.append(start + listed(f"{name} (x{show(ratio)})" for ratio, name in groups[word])
                         + ".")
    return " ".join(parts)


def about_series(name, pairs, style):
    """How a line runs: against its mark, as growth, or to its best place."""
    unit, label = unit_of(style["y"]), style.get("x_label") or "x"
    pairs = sorted((number(x), value) for x, value in pairs if number(x))
    if len(pairs) < 2:
        return ""
    (first, low), (last, high) = pairs[0], pairs[-1]
    power = exponent([(x, value.middle) for x, value in pairs])
    middles = [value.middle for _, value in pairs]
    if unit and power is not None and power >= STEADY and middles == sorted(middles):
        return (f"{name}: {plain(last / first)} times the {label} take "
                f"{show(high.middle / low.middle)} times as long (time grows as "
                f"{label}^{power:.2f}).")
    named = [(f"{plain(x)} {label}", value) for x, value in pairs]
    return f"{name}: {ranking(named, unit, style['y'].endswith('_ms'), str)}"


def about_panel(rows, style):
    unit = unit_of(style["y"])
    if style["kind"] == "bars":
        pairs = pairs_of(rows, style["y"], "x")
        if pairs and pairs[0][0] in BASES:
            return about_default(pairs, unit)
        return ranking(pairs, unit, style["y"].endswith("_ms"))
    sentences = [about_series(capital(series) or "All", pairs_of(members, style["y"], "x"), style)
                 for series, members in in_groups(rows, "series").items()]
    sentences = [sentence for sentence in sentences if sentence]
    last = max((number(row["x"]) for row in rows if is_measured(row) and number(row["x"])),
               default=None)
    there = [row for row in rows if number(row["x"]) == last]
    best = ranking(pairs_of(there, style["y"], "series"), unit, style["y"].endswith("_ms"), str)
    if best:
        sentences.append(f"With {plain(last)} {style.get('x_label', '')}: {best}")
    return " ".join(sentences)


def about_mark(table):
    """Where each series' interval is above the mark: one sentence for all panels."""
    mark, never = f"{table.plot['mark']:g}", []
    for series, rows in in_groups([row for row in table.drawn if is_measured(row)],
                                  "series").items():
        values = [(row, interval(row, table.plot["y"])) for row in rows]
        values = [(row, value) for row, value in values if value]
        if not values:
            continue
        above = in_groups([row for row, value in values
                           if value.known and value.low > table.plot["mark"]], "panel")
        count = sum(map(len, above.values()))
        ends = [show(end(value.middle for _, value in values)) for end in (min, max)]
        if not above:
            never.append(f"{series} (at most {ends[1]})")
        elif count == len(values):
            yield capital(series), f"everywhere above {mark}, {ends[0]} to {ends[1]}."
        else:
            yield capital(series), (
                f"{ends[0]} to {ends[1]}; clearly above {mark} in {count} of {len(values)} cases: "
                + "; ".join(f"{panel or 'here'} with {listed(plain(number(row['x'])) for row in mine)}"
                            for panel, mine in above.items()) + ".")
    if never:
        yield "", f"Nowhere clearly above {mark}: {listed(never)}."


def about_gains(table):
    """Ways to sample are compared at equal samples and at equal time, not along their lines."""
    return [(f"{panel}, equal: {equal}", ranking(pairs_of(rows, "gain", "series"), "", False)
             + " Each error is that of one image.")
            for (panel, equal), rows in in_groups(table.measured, "panel", "equal").items()]


def about_metropolis(table):
    """At each time, not along the lines."""
    for panel, rows in in_groups(table.measured, "panel").items():
        parts = []
        for row in sorted(rows, key=lambda row: number(row["seconds"])):
            gain = interval(row, "gain")
            if gain:
                winner = ("" if not gain.known else "mlt wins" if gain.low > 1 else
                          "path tracing wins" if gain.high < 1 else "no significant difference")
                parts.append(f"{with_interval(gain)} after {row['seconds']} s"
                             + f" ({winner or 'without a spread'})")
        if parts:
            yield panel, ("relMSE of path tracing divided by that of Metropolis light transport at "
                          f"equal time: {listed(parts)}.")


def about_steps(table):
    """The steps of a ladder are compared with those before them."""
    for panel, rows in in_groups(table.measured, "panel").items():
        pairs = pairs_of(rows, "kernel_ms", "x")
        steps = [(name, *change(before, value)) for (_, before), (name, value)
                 in zip(pairs, pairs[1:])]
        yield panel, "Time against the step before: " + listed(
            f"{name} x{show(ratio)}" + (f" ({word})" if word not in ("faster", "slower") else "")
            for name, word, ratio in steps) + "."


def meaning(table):
    """[(panel, sentences)]"""
    if {"gain_median", "seconds"} <= set(table.columns):
        found = list(about_metropolis(table))
    elif {"gain", "equal"} <= set(table.columns):
        found = about_gains(table)
    elif {"gain", "panel"} <= set(table.columns):
        found = list(about_steps(table))
    elif is_scaling(table):
        found = list(about_scaling(table))
    elif is_processes(table):
        found = list(about_processes(table))
    elif "law" in table.facts:
        return [("", line) for line in table.facts["conclusions"]]
    elif table.plot and table.plot.get("mark") is not None:
        found = list(about_mark(table))
    elif table.plot:
        found = [(panel, about_panel(rows, style_of(table, panel)))
                 for panel, rows in in_groups(table.drawn, "panel").items()]
    else:
        return []
    once = sum(1 for row in table.measured  # `seeds` are more than one
               if row.get("repeat") == "1" and not row.get("seeds"))
    gone = [row for row in table.rows if not is_measured(row)]
    if gone:
        found.append(("", f"{len(gone)} of {len(table.rows)} configurations were not measured "
                      f"({listed(sorted({row['status'] for row in gone}))}); the table says why."))
    if once:
        found.append(("", f"{once} of {len(table.rows)} configurations were measured once and have "
                      "no interval."))
    return [(panel, text) for panel, text in found if text]
