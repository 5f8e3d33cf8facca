"""The student paper's claims, each held against the tables of a device."""
from .tables import Interval, in_groups, interval, number
from .words import change, exponent, listed, plain, show, with_interval

NOT_MEASURED = "not measured"


def growth(device):
    table = device.to_judge("image_size")
    lines, powers = [], []
    for series, rows in (in_groups(table.measured, "series").items() if table else ()):
        points = sorted((number(row["x"]), interval(row, "image_ms").middle) for row in rows
                        if interval(row, "image_ms") and number(row["x"]))
        if len(points) < 3:
            continue
        (x1, t1), (x2, t2), (xn, tn) = points[0], points[1], points[-1]
        power = exponent(points)
        powers.append(power)
        as_exponential = (t2 / t1) ** min((xn - x1) / (x2 - x1), 300)
        lines.append(f"{series}: {plain(xn / x1)} times the pixels take {show(tn / t1)} times as "
                     f"long (pixels^{power:.2f}; an exponential through the first two sizes "
                     f"would give {show(as_exponential)} times)")
    if not powers:
        return NOT_MEASURED, "At least three image sizes are needed.", "image_size"
    verdict = ("refuted" if max(powers) < 1.2 else "confirmed" if min(powers) > 3 else "depends")
    return verdict, "; ".join(lines) + ".", "image_size"


def idle_share(row):
    """Threads of a launch with one thread a pixel that have no pixel."""
    width, height = int(row["width"]), int(row["height"])
    across, down = (int(side) for side in row["block"].split("x"))
    threads = -(-width // across) * across * -(-height // down) * down
    return 1 - width * height / threads


def larger_blocks(device):
    table = device.to_judge("block_size")
    steps, paper = {"slower": 0, "faster": 0, "no significant difference": 0, "not known": 0}, []
    for (panel, series), rows in (in_groups(table.measured, "panel", "series").items()
                                  if table else ()):
        pairs = sorted(((number(row["x"]), interval(row, "kernel_ms"), row) for row in rows),
                       key=lambda entry: entry[0])
        for (_, small, _), (_, large, _) in zip(pairs, pairs[1:]):
            steps[change(small, large)[0]] += 1
        if series == "megakernel, pixel":
            paper.append(f"A thread per pixel at {panel}: " + ", ".join(
                f"{row['block']} {with_interval(value, 'ms')}, {idle_share(row):.1%} idle"
                for _, value, row in pairs))
    total = sum(steps.values())
    if not total:
        return NOT_MEASURED, "", "block_size"
    verdict = ("confirmed" if steps["slower"] == total else
               "refuted" if steps["slower"] == 0 else "depends")
    return verdict, (f"Of {total} steps to the next larger block {steps['slower']} are slower, "
                     f"{steps['faster']} faster, {steps['no significant difference']} without a "
                     f"significant difference. {'. '.join(paper)}.".replace(" .", "")), "block_size"


def toggled(device, choice):
    """(mode, word, ratio, default, value) for a row of toggles."""
    table = device.to_judge("toggles")
    for mode, rows in (in_groups(table.measured, "panel").items() if table else ()):
        named = {row["x"]: interval(row, "kernel_ms") for row in rows}
        if named.get("default") and named.get(choice):
            yield (mode, *change(named["default"], named[choice]), named["default"], named[choice],
                   named)


def growing_scenes(device):
    """Shared against global memory as spheres grow in number: a phrase for each execution."""
    table = device.to_judge("scene_memory")
    for panel, rows in (in_groups(table.measured, "panel").items() if table else ()):
        parts = []
        for count, mine in in_groups(rows, "x").items():
            times = {row["series"]: interval(row, "kernel_ms") for row in mine}
            if times.get("shared") and times.get("global"):
                word, ratio = change(times["global"], times["shared"])
                parts.append(f"{plain(number(count))} spheres {show(ratio)} ({word})")
        if parts:
            yield f"{panel}, times global memory: {', '.join(parts)}"


def shared_memory(device):
    lines, growing = [], list(growing_scenes(device))
    for mode, word, ratio, default, value, named in toggled(device, "scene-memory shared"):
        line = (f"{mode}: it runs, {with_interval(value, 'ms')}, {show(ratio)} times the default "
                f"({with_interval(default, 'ms')}; {word})")
        if named.get("scene-memory global"):
            word, ratio = change(named["scene-memory global"], value)
            line += f" and {show(ratio)} times global memory ({word})"
        lines.append(line)
    source = ", ".join(["toggles"] * bool(lines) + ["scene_memory"] * bool(growing))
    if not source:
        return NOT_MEASURED, "", "toggles"
    return "refuted", "; ".join(lines + growing) + ".", source


def reduced_branching(device):
    found = list(toggled(device, "branching reduced"))
    if not found:
        return NOT_MEASURED, "", "toggles"
    helped = [ratio < 0.9 and word == "faster" for _, word, ratio, *_ in found]
    verdict = "confirmed" if all(helped) else "depends" if any(helped) else "refuted"
    return verdict, "; ".join(f"{mode}: {show(ratio)} times the time of the default ({word})"
                              for mode, word, ratio, *_ in found) + ".", "toggles"


def gpu_over_cpu(device):
    table = device.to_judge("image_size")
    by_size = in_groups(table.measured if table else [], "x")
    rows = by_size[max(by_size, key=lambda x: number(x) or 0)] if by_size else []
    times = {row["series"]: interval(row, "image_ms") for row in rows}
    gpu = {name: time for name, time in times.items() if "CUDA" in name and time}
    cpu = {name: time for name, time in times.items() if "CPU" in name and time}
    if not (gpu and cpu):
        return NOT_MEASURED, "", "image_size"
    fastest = min(gpu, key=lambda name: gpu[name].middle)
    ratios = {name: time.middle / gpu[fastest].middle for name, time in cpu.items()}
    # Within a fifth of ten, whatever it is compared with.
    near = [8 <= ratio <= 12 for ratio in ratios.values()]
    least, most = (f"{end(ratios.values()):,.0f}" for end in (min, max))
    verdict = ("confirmed" if all(near) else
               "refuted" if max(ratios.values()) < 8 else
               f"yes, by {' to '.join(dict.fromkeys((least, most)))} times"
               if min(ratios.values()) > 12 else "depends")
    cores = table.facts.get("host", {}).get("cores")
    text = (f"At {rows[0]['width']}x{rows[0]['height']} {fastest} is "
            + listed(f"{show(ratio)} times as fast as {name}" for name, ratio in ratios.items())
            + (f" (serial: one thread; the others: all {cores} cores)." if cores else "."))
    once = any(not time.known for time in cpu.values())
    if any(row.get("extrapolated") == "yes" for row in rows):
        text += " The CPU's times are extrapolated from fewer samples."
    return verdict, text + (" The CPU was measured once." if once else ""), "image_size"


def importance_sampling(device):
    """Errors fall as 1 / samples, so the quotient of errors is that of the samples needed."""
    table = device.to_judge("sampling")
    gains = []
    for (panel, equal), rows in (in_groups(table.measured, "panel", "equal").items()
                                 if table else ()):
        errors = {row["series"]: number(row["relmse"]) for row in rows}
        uniform, ours = errors.get("sampling uniform, nee off"), errors.get("nee off")
        if equal != "time" and uniform and ours:
            gains.append((uniform / ours, f"{panel}, {equal}"))
    if not gains:
        return NOT_MEASURED, "", "sampling"
    more = [gain > 1 for gain, _ in gains]
    verdict = "confirmed" if all(more) else "depends" if any(more) else "refuted"
    return verdict, ("Samples that uniform directions need for the error of importance sampling by "
                     "the BSDF: " + ", ".join(f"{show(gain)} times ({where})"
                                              for gain, where in gains)
                     + ". Each error is of one image, without an interval."), "sampling"


def metropolis(device):
    """At equal samples: a mutation traces a path, so the gain at equal time times paths by
    mutations is that at equal numbers of them, as errors fall as 1 / samples."""
    table = device.to_judge("metropolis")
    words, lines = [], []
    for panel, rows in (in_groups(table.measured, "panel").items() if table else ()):
        both = {row["series"]: row for row in sorted(rows, key=lambda row: float(row["seconds"]))
                if row["x"]}  # those of the longest time
        gain = interval(both["mlt"], "gain") if {"mlt", "path"} <= set(both) else None
        if not gain:
            continue
        factor = number(both["path"]["samples"]) / number(both["mlt"]["samples"])
        gain = Interval(factor * gain.middle, *((factor * gain.low, factor * gain.high)
                                                if gain.known else (None, None)), gain.kind)
        words.append("not known" if not gain.known else "fewer" if gain.low > 1 else
                     "more" if gain.high < 1 else "no significant difference")
        apart = both["mlt"].get("references") == "DISAGREE"
        lines.append(f"{panel} {with_interval(gain)} ({words[-1]}"
                     + (", by a reference that is not sure)" if apart else ")"))
    if not words:
        return NOT_MEASURED, "", "metropolis"
    verdict = ("confirmed" if all(word == "fewer" for word in words) else
               "refuted" if "fewer" not in words else "depends")
    return verdict, ("Paths that path tracing needs for the error (relMSE) of one mutation of "
                     f"Metropolis light transport: {listed(lines)}."), "metropolis"


# The claim, the rule of its verdict (else it depends), and who applies it.
CLAIMS = (
    ("Time grows exponentially with the size of the image.",
     "refuted where time = pixels^p with p below 1.2 in every mode", growth),
    ("Larger blocks are slower, because of unused threads.",
     "confirmed if every step to a larger block is slower, refuted if none is", larger_blocks),
    ("Shared memory cannot be used.", "refuted where it runs", shared_memory),
    ("Reduced branching could greatly help.",
     "confirmed if it saves a tenth in every mode, refuted if in none", reduced_branching),
    ("The GPU is ten times faster than the CPU.",
     "confirmed if 8 to 12 times against every CPU mode, refuted if less against all, "
     "yes if more against all",
     gpu_over_cpu),
    ("Importance sampling needs fewer samples.",
     "confirmed if the error at equal samples is lower in every scene, refuted if in none",
     importance_sampling),
    ("Metropolis light transport needs fewer samples.",
     "confirmed if the error at equal samples is lower in every scene, refuted if in none",
     metropolis))


def audit(device):
    """[(claim, rule, verdict, numbers, table)]"""
    return [(claim, rule, *judge(device)) for claim, rule, judge in CLAIMS]
